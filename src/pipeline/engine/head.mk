# The tasks of this project for `make -j`, a rule for each; written by `signorini dag --make`, and by make
# itself when the project has changed. Run it in the folder of the project; afterwards `signorini run`
# writes figures/ and report/.
SIGNORINI := PROGRAM
TASK := $(SIGNORINI) run --quiet --cache-dir CACHE --task
RAYON_NUM_THREADS ?= 1
export RAYON_NUM_THREADS

.PHONY: all always
all:

this := $(lastword $(MAKEFILE_LIST))
$(this): always
	@$(SIGNORINI) dag --make --cache-dir CACHE > $@.new
	@if cmp -s $@.new $@; then rm $@.new; else mv $@.new $@; fi
