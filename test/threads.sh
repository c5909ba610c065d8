#!/bin/sh
# Two contexts and four recording threads under ThreadSanitizer, in a folder configured with
# -Db_sanitize=thread: runs threads_test, and shows with a deliberate race that a race would be
# seen; then installs that girih, and does the same with examples/renderer, which is built outside
# the tree with pkg-config alone. Usage: threads.sh SOURCE_FOLDER BUILD_FOLDER
set -eu
source=$1
build=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# The driver's compiler holds more locks at once than the deadlock detector has room for.
common="detect_deadlocks=0:suppressions=$source/test/threads.supp"

# Kernels that spread addresses widely leave no room for the sanitizer's own.
fixed=
if setarch -R true 2>/dev/null; then
    fixed='setarch -R'
fi

# A race that is there must be reported, in girih's own code.
status=0
TSAN_OPTIONS="$common:exitcode=66" $fixed "$build/test/threads_test" --prove >"$scratch/prove.out" 2>&1 ||
    status=$?
if [ "$status" -ne 66 ] || ! grep -q 'data race' "$scratch/prove.out" ||
    ! grep -q 'girih_cmd_refine' "$scratch/prove.out"; then
    tail -n 60 "$scratch/prove.out" >&2
    echo "threads.sh: one plan recorded on two threads was not reported (exit $status)" >&2
    exit 1
fi
echo "one plan recorded on two threads: reported, as it must be"

status=0
TSAN_OPTIONS="$common:exitcode=66:print_suppressions=1" $fixed "$build/test/threads_test" \
    --no-validation >"$scratch/run.out" 2>&1 || status=$?
if [ "$status" -ne 0 ]; then
    head -n 120 "$scratch/run.out" >&2
    echo "threads.sh: failed with ThreadSanitizer (exit $status)" >&2
    exit 1
fi
grep -v '^=*$' "$scratch/run.out"

# The library alone, which is all that is built here.
renderer=$scratch/renderer
cp -r "$source/examples/renderer" "$renderer"
if ! {
    meson install -C "$build" --no-rebuild --tags devel,runtime --destdir "$scratch/root" &&
        description=$(find "$scratch/root" -name girih.pc) &&
        # What lies under a DESTDIR is not at its prefix yet.
        sed -i "s,^prefix=,&$scratch/root," "$description" &&
        export PKG_CONFIG_PATH="${description%/*}" &&
        make -C "$renderer" CFLAGS='-O1 -g -fsanitize=thread' LDFLAGS=-fsanitize=thread
} >"$scratch/install.out" 2>&1; then
    tail -n 30 "$scratch/install.out" >&2
    echo "threads.sh: no examples/renderer with ThreadSanitizer" >&2
    exit 1
fi
LD_LIBRARY_PATH=$(pkg-config --variable=libdir girih)${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}
export LD_LIBRARY_PATH
# Layers are looked for in VK_LAYER_PATH alone: none is there, since they are not instrumented.
status=0
VK_LAYER_PATH=$scratch/none TSAN_OPTIONS="$common:exitcode=66:print_suppressions=1" \
    $fixed "$renderer/renderer" threads >"$scratch/renderer.out" 2>&1 || status=$?
if [ "$status" -ne 0 ]; then
    head -n 120 "$scratch/renderer.out" >&2
    echo "threads.sh: examples/renderer failed with ThreadSanitizer (exit $status)" >&2
    exit 1
fi
echo "examples/renderer, against the installed library:"
grep -v '^=*$' "$scratch/renderer.out"
cat <<'END'
not checked here:
- inside the driver, its threads and its shaders, which are not instrumented: races that the driver
  takes part in are suppressed, so two threads in one Vulkan object at once are not seen;
- what the validation layer checks, those threads among it: it is not instrumented either, and off
  here. It is on in the plain runs of both programs (tests threads and install), and sees there
  what threads do to one Vulkan object at the very same time;
- mapped memory that the device writes: only the host's accesses are seen;
- the order of locks (detect_deadlocks=0): girih takes none.
END
