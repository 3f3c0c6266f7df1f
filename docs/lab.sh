#!/bin/bash
# Writes docs/lab.md and the pictures in docs/images/lab by running every experiment of `strata lab`.
#
#   docs/lab.sh
#
# All numbers but times, and what follows from them, are the same each time.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

strata=../build/release/bin/strata
[[ -x $strata ]] || { echo "lab.sh: first build: deploy/build.sh release strata" >&2; exit 2; }
mkdir -p images/lab
{
  cat <<'HEAD'
# The lab

`strata lab NAME` runs a classic experiment of Monte Carlo integration, by the renderer's own samplers, sampling
routines and strategies (`worker/`), and prints a table. This page is what `strata lab all --markdown` prints; `docs/lab.sh`
writes it. Sections are those of Pharr, Jakob and Humphreys, *Physically Based Rendering*, 4th edition.

V is the variance of one estimate, T the time it takes (on one core, of a machine at other work too), and 1/(V T) its
efficiency: how much certainty a second buys. V follows from `--seed` to the last digit, T does not. "-" is no number.

HEAD
  "$strata" lab all --markdown --out images/lab
  cat <<'TAIL'
## Options

| Option | Meaning |
|---|---|
| `--samples N` | how many, from 2 up; what they are is in the next table |
| `--seed S` | of all random numbers (0) |
| `--csv` | comma-separated values with nine digits instead of the table |
| `--markdown` | a section of this page |
| `--out FILE` | the plot as `.png` or `.svg`, by gnuplot (`apt install gnuplot-nox`), or the picture as `.png` or `.exr`; of `all` a folder |

TAIL
  echo '| Experiment | `--samples` counts | by default |'
  echo '|---|---|---:|'
  "$strata" lab list --csv | tail -n +2 | while IFS=, read -r name samples default; do
    echo "| $name | $samples | $default |"
  done
} >lab.md.new
mv lab.md.new lab.md
