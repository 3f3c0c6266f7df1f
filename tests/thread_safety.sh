#!/bin/bash
# Clang's thread-safety analysis of every file that takes a lock. Compiles nothing, but needs
# build/release: its generated headers, and what it knows of each file's flags.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

analyse() {
  clang++ -std=c++20 -march=x86-64-v3 -fsyntax-only -I. -Wthread-safety -Werror=thread-safety "$@"
}

# The control: a field read without its lock must be refused, for this reason.
control='#include "common/sync.h"
struct Counter { strata::Mutex mutex; int count STRATA_GUARDED_BY(mutex) = 0; };
int Read(Counter& counter) { return counter.count; }'
findings=$(analyse -x c++ - <<<"$control" 2>&1 || true)
if [[ $findings != *"requires holding mutex 'counter.mutex'"* ]]; then
  echo "thread_safety.sh: the analysis does not see a field read without its lock" >&2
  exit 1
fi

# Sources that include the lock, and those of the headers that do.
sources_including() {
  git grep --untracked --files-with-matches --fixed-strings "#include \"$1\"" -- '*.cpp' || true
}
mapfile -t headers < <(
  git grep --untracked --files-with-matches --fixed-strings '#include "common/sync.h"' -- '*.h')
mapfile -t files < <(
  for header in common/sync.h "${headers[@]}"; do sources_including "$header"; done | sort --unique)

# The include paths and definitions a source is compiled with.
flags_of() {
  grep --fixed-strings -- "-c $PWD/$1\"" build/release/compile_commands.json | head -n 1 |
    grep --only-matching --extended-regexp -- '-(D|I|isystem )[^ ]+' |
    sed -e 's/^-isystem /-isystem/' -e 's/\\\\\\"/"/g'
}
unclean=0
for file in "${files[@]}"; do
  mapfile -t flags < <(flags_of "$file")
  analyse "${flags[@]}" "$file" || unclean=$((unclean + 1))
done
echo "Thread-safety analysis: ${#files[@]} files, $unclean with findings."
((unclean == 0))
