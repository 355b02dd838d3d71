#!/usr/bin/env bash
# Runs clang-tidy, as .clang-tidy says, on lamina's own code: all of it, or what lies in folders with
# the given text in their path. Sources are read as a fast build compiles them, several at a time:
# headers, which cost most, are read a tenth as often. What was found clean once is not read again:
# its number, of all that clang-tidy sees of it, is kept in lamina_tidy of XDG_CACHE_HOME or ~/.cache.
set -euo pipefail
cd "$(dirname "$0")/.."
source ./setup.sh
install_packages "${build_packages[@]}" "${tidy_packages[@]}"
export clean=${XDG_CACHE_HOME:-$HOME/.cache}/lamina_tidy
mkdir -p "$clean"

cmake --preset tidy >/dev/null
# Headers that the build writes.
ninja -C build/tidy -t targets all | sed -n 's/^\(lamina_.*_fingerprint\): phony$/\1/p' | xargs ninja -C build/tidy >/dev/null

# Prints number and path of what is to be read, where the path has the given text. A number is a hash
# of the version of clang-tidy, its settings, the command of the compiler, and every file that it reads,
# whole: comments and macros count. Paths are those below the checkout, so that others have the same.
numbers() {
  python3 - "$@" <<'END'
import concurrent.futures, functools, hashlib, json, os, re, shlex, subprocess, sys

text, root = sys.argv[1], os.getcwd()
with open("build/tidy/compile_commands.json") as file:
    units = [unit for unit in json.load(file) if text in unit["file"]
             and not re.search(r"_verify_interface_header_sets/|/nothing\.cpp$", unit["file"])]
with open(".clang-tidy") as file:
    settings = file.read() + subprocess.run(["clang-tidy-19", "--version"], capture_output=True, text=True, check=True).stdout
extra = re.search(r"^ExtraArgs: \[(.*?)\]", settings, re.MULTILINE).group(1).split(", ")


@functools.lru_cache(None)
def hash_of(path):
    with open(path, "rb") as file:
        return hashlib.sha256(file.read().replace(root.encode(), b"")).hexdigest()


def number(unit):
    words = shlex.split(unit["command"])
    at = words.index("-o")
    result = subprocess.run([*words[:at], *words[at + 2:], *extra, "-M"], cwd=unit["directory"], capture_output=True,
                            text=True)
    if result.returncode != 0:
        return "unknown"  # which clang-tidy says more of
    files = shlex.split(result.stdout.replace("\\\n", " ").partition(":")[2])
    paths = {os.path.normpath(os.path.join(unit["directory"], file)) for file in files}
    parts = sorted(f"{path.replace(root, '')} {hash_of(path)}" for path in paths)
    return hashlib.sha256("\n".join([settings, unit["command"].replace(root, ""), *parts]).encode()).hexdigest()


with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    for unit, value in zip(reversed(units), pool.map(number, reversed(units))):
        print(value, unit["file"])
END
}

check() {
  local findings
  if [ -e "$clean/$1" ]; then
    touch "$clean/$1"
    return
  fi
  if findings=$(clang-tidy-19 -quiet -p build/tidy "$2" 2>&1); then
    [ "$1" = unknown ] || : >"$clean/$1"
    return
  fi
  echo "$findings" | grep -v 'warnings.* generated'
  return 1
}
export -f check
numbers "${1:-}" >build/tidy/numbers
known=$(cut -d' ' -f1 build/tidy/numbers | (cd "$clean" && xargs -r ls 2>/dev/null || true) | wc -l)
echo "$(wc -l <build/tidy/numbers) batches of sources, of which $known are known as clean"
find "$clean" -type f -mtime +60 -delete
xargs -a build/tidy/numbers -P "$(nproc)" -L 1 bash -c 'check "$@"' _
