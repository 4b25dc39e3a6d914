# The tasks of this project for Snakemake, a job for each; written by `signorini dag --snakemake`.
# Run it in the folder of the project; afterwards `signorini run` writes figures/ and report/.
import json
import os
import subprocess

