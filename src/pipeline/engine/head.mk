# In the target of a rule % would stand for any text.
MADE := $(subst %,\%,$(STAMPS))
TASK := $(SIGNORINI) run --quiet --cache-dir $(CACHE) --task
RAYON_NUM_THREADS ?= 1
export RAYON_NUM_THREADS

.PHONY: all always
all:

this := $(lastword $(MAKEFILE_LIST))
ifeq ($(wildcard $(this)),)
$(error make cannot tell where the path of this makefile ends, since it has a space: give another name without one)
endif
quoted = '$(subst ','\'',$1)'
$(subst %,\%,$(this)): always
	@file=$(call quoted,$(or $(realpath $@),$@)); if [ -f "$$file" ]; then \
	    new=$$file.$$$$.new; trap 'rm -f "$$new"' EXIT HUP INT TERM; \
	    cp -p "$$file" "$$new" && $(SIGNORINI) dag --make --cache-dir $(CACHE) > "$$new" \
	        && { cmp -s "$$new" "$$file" || mv -f "$$new" "$$file"; }; fi
