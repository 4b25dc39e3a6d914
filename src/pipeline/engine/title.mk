# The tasks of this project for `make -j`, a rule for each; written by `signorini dag --make`, and by make
# itself when the project has changed. Run it in the folder of the project; afterwards `signorini run`
# writes figures/ and report/.
