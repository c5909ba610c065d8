#!/bin/sh
# Two contexts and four recording threads under ThreadSanitizer: builds girih and threads_test with
# it in a folder of its own, runs the test, and shows with a deliberate race that a race would be
# seen. Usage: threads.sh [SOURCE_FOLDER]
set -eu
source=${1:-$(dirname "$0")/..}
source=$(cd "$source" && pwd)
build=$(mktemp -d)
trap 'rm -rf "$build"' EXIT

if ! meson setup "$build" "$source" --buildtype=debugoptimized -Db_sanitize=thread \
    -Db_lundef=false >"$build/setup.out" 2>&1 ||
    ! ninja -C "$build" -j "${JOBS:-2}" test/threads_test >"$build/ninja.out" 2>&1; then
    tail -n 30 "$build/setup.out" "$build/ninja.out" >&2
    echo "threads.sh: no build with ThreadSanitizer" >&2
    exit 1
fi
# The driver's compiler holds more locks at once than the deadlock detector has room for.
common="detect_deadlocks=0:suppressions=$source/test/threads.supp"

# Kernels that spread addresses widely leave no room for the sanitizer's own.
fixed=
if setarch -R true 2>/dev/null; then
    fixed='setarch -R'
fi

# A race that is there must be reported, in girih's own code.
status=0
TSAN_OPTIONS="$common:exitcode=66" $fixed "$build/test/threads_test" --prove >"$build/prove.out" 2>&1 ||
    status=$?
if [ "$status" -ne 66 ] || ! grep -q 'data race' "$build/prove.out" ||
    ! grep -q 'girih_cmd_refine' "$build/prove.out"; then
    tail -n 60 "$build/prove.out" >&2
    echo "threads.sh: one plan recorded on two threads was not reported (exit $status)" >&2
    exit 1
fi
echo "one plan recorded on two threads: reported, as it must be"

status=0
TSAN_OPTIONS="$common:exitcode=66:print_suppressions=1" $fixed "$build/test/threads_test" \
    --no-validation >"$build/run.out" 2>&1 || status=$?
if [ "$status" -ne 0 ]; then
    head -n 120 "$build/run.out" >&2
    echo "threads.sh: failed with ThreadSanitizer (exit $status)" >&2
    exit 1
fi
grep -v '^=*$' "$build/run.out"
cat <<'END'
not checked here:
- inside the driver, its threads and its shaders, which are not instrumented: races that the driver
  takes part in are suppressed, so two threads in one Vulkan object at once are not seen (the
  validation layer looks for those in the plain run of the test);
- mapped memory that the device writes: only the host's accesses are seen;
- the order of locks (detect_deadlocks=0): girih takes none.
END
