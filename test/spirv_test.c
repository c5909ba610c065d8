// Modules moved among a host's descriptor sets and push constants: what must move moves, and every
// other word stays.
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "context.h"

#define GIRIH_SHADERS_WANT_CODE
#include "shader_list.h"

typedef struct module {
    const char *name;
    const uint32_t *words;
    size_t bytes;
} module;

static const module modules[] = {
#define MODULES(NAME)                                                                              \
    {#NAME, girih_spirv_##NAME, sizeof girih_spirv_##NAME},                                        \
        {#NAME "_few", girih_spirv_##NAME##_few, sizeof girih_spirv_##NAME##_few},
    GIRIH_SHADERS(MODULES)
#undef MODULES
};
#define MODULE_COUNT (sizeof modules / sizeof *modules)

typedef struct move {
    uint32_t set, push_offset;
} move;

static const move moves[] = {{0, 0}, {1, 0}, {0, 16}, {6, 100}};
#define MOVE_COUNT (sizeof moves / sizeof *moves)

static uint32_t *copy_of(const uint32_t *words, size_t bytes) {
    uint32_t *copy = malloc(bytes);
    assert_non_null(copy);
    memcpy(copy, words, bytes);
    return copy;
}

// What a module becomes, found by another way than the library's: one walk that notes by id which
// types pointers point to and which of these a push constant variable has, then one that moves.
static uint32_t *expected(const module *m, move by, uint32_t *sets, uint32_t *members) {
    const size_t count = m->bytes / 4;
    uint32_t *words = copy_of(m->words, m->bytes);
    uint32_t *pointee = calloc(words[3], sizeof *pointee);
    unsigned char *pushed = calloc(words[3], 1);
    assert_true(pointee && pushed);
    for (size_t n = 5; n < count; n += words[n] >> 16) {
        switch (words[n] & 0xffff) {
        case 32: // OpTypePointer
            pointee[words[n + 1]] = words[n + 3];
            break;
        case 59: // OpVariable, PushConstant
            if (words[n + 3] == 9) {
                pushed[pointee[words[n + 1]]] = 1;
            }
            break;
        default:
            break;
        }
    }
    *sets = 0;
    *members = 0;
    for (size_t n = 5; n < count; n += words[n] >> 16) {
        const uint32_t opcode = words[n] & 0xffff;
        if (opcode == 71 && words[n + 2] == 34) { // OpDecorate DescriptorSet
            words[n + 3] += by.set;
            ++*sets;
        } else if (opcode == 72 && words[n + 3] == 35 && pushed[words[n + 1]]) { // Offset
            words[n + 4] += by.push_offset;
            ++*members;
        }
    }
    free(pushed);
    free(pointee);
    return words;
}

static void shaders_move(void **state) {
    (void)state;
    uint32_t with_push = 0;
    for (size_t n = 0; n < MODULE_COUNT; ++n) {
        for (size_t turn = 0; turn < MOVE_COUNT; ++turn) {
            const move by = moves[turn];
            uint32_t sets, members;
            uint32_t *wanted = expected(&modules[n], by, &sets, &members);
            uint32_t *moved = copy_of(modules[n].words, modules[n].bytes);
            assert_true(girih_spirv_place(moved, modules[n].bytes, by.set, by.push_offset));
            assert_memory_equal(moved, wanted, modules[n].bytes);
            // Each of the library's shaders reads the frame block and an array at least, and has
            // the whole push constant block or none.
            assert_true(sets >= 2);
            assert_true(members == 0 || members == GIRIH_PUSH_CONSTANT_BYTES / 4);
            with_push += members != 0;
            free(moved);
            free(wanted);
        }
    }
    assert_true(with_push > 0);
}

// Moving on by one set at a time ends where moving at once does.
static void moves_add_up(void **state) {
    (void)state;
    for (size_t n = 0; n < MODULE_COUNT; ++n) {
        uint32_t *once = copy_of(modules[n].words, modules[n].bytes);
        uint32_t *twice = copy_of(modules[n].words, modules[n].bytes);
        assert_true(girih_spirv_place(once, modules[n].bytes, 3, 36));
        assert_true(girih_spirv_place(twice, modules[n].bytes, 1, 4));
        assert_true(girih_spirv_place(twice, modules[n].bytes, 2, 32));
        assert_memory_equal(once, twice, modules[n].bytes);
        free(once);
        free(twice);
    }
}

#define OP(LENGTH, CODE) ((uint32_t)(LENGTH) << 16 | (CODE))
#define DECORATE_SET(ID, SET) OP(4, 71), ID, 34, SET
#define MEMBER_OFFSET(TYPE, MEMBER, BYTES) OP(5, 72), TYPE, MEMBER, 35, BYTES
#define STRUCT(ID, MEMBER) OP(3, 30), ID, MEMBER
#define PAIR_STRUCT(ID, FIRST, SECOND) OP(4, 30), ID, FIRST, SECOND
#define POINTER(ID, STORAGE, TYPE) OP(4, 32), ID, STORAGE, TYPE
#define VARIABLE(TYPE, ID, STORAGE) OP(4, 59), TYPE, ID, STORAGE
#define UNIFORM 2
#define PUSH_CONSTANT 9

// Struct 2 is the push constant block of two variables, struct 1 a member of it, struct 3 a uniform
// block; struct 4 has a push constant pointer, but no variable.
static const uint32_t blocks[] = {0x07230203,
                                  0x00010300,
                                  0,
                                  20,
                                  0,
                                  DECORATE_SET(12, 5),
                                  OP(4, 71),
                                  12,
                                  33,
                                  7, // Binding
                                  MEMBER_OFFSET(1, 0, 0),
                                  MEMBER_OFFSET(1, 1, 4),
                                  MEMBER_OFFSET(2, 0, 0),
                                  MEMBER_OFFSET(2, 1, 48),
                                  MEMBER_OFFSET(3, 0, 0),
                                  MEMBER_OFFSET(4, 0, 0),
                                  OP(3, 21),
                                  0x10,
                                  OP(4, 71), // an operand that reads like an instruction
                                  PAIR_STRUCT(1, 0x10, 0x10),
                                  PAIR_STRUCT(2, 1, 1),
                                  STRUCT(3, 1),
                                  STRUCT(4, 0x10),
                                  POINTER(5, PUSH_CONSTANT, 2),
                                  POINTER(6, UNIFORM, 3),
                                  POINTER(7, PUSH_CONSTANT, 4),
                                  POINTER(8, PUSH_CONSTANT, 2),
                                  VARIABLE(5, 10, PUSH_CONSTANT),
                                  VARIABLE(8, 11, PUSH_CONSTANT),
                                  VARIABLE(6, 12, UNIFORM)};

static void blocks_move_alone(void **state) {
    (void)state;
    uint32_t *words = copy_of(blocks, sizeof blocks);
    assert_true(girih_spirv_place(words, sizeof blocks, 2, 100));
    for (size_t n = 0; n < sizeof blocks / 4; ++n) {
        uint32_t add = 0;
        if (n == 5 + 3) { // the only DescriptorSet
            add = 2;
        } else if (n == 13 + 2 * 5 + 4 || n == 13 + 3 * 5 + 4) { // struct 2's offsets
            add = 100;
        }
        assert_int_equal(words[n], blocks[n] + add);
    }
    free(words);
}

// A copy of exactly `bytes` bytes, so that a sanitizer sees any read beyond; refused and untouched.
static void refuse(const uint32_t *words, size_t bytes) {
    uint32_t *copy = malloc(bytes ? bytes : 1);
    assert_non_null(copy);
    memcpy(copy, words, bytes);
    assert_false(girih_spirv_place(copy, bytes, 1, 16));
    assert_memory_equal(copy, words, bytes);
    free(copy);
}

static void malformed_modules(void **state) {
    (void)state;
    assert_false(girih_spirv_place(NULL, 0, 1, 16));
    for (size_t bytes = 0; bytes < 20; ++bytes) {
        refuse(blocks, bytes);
    }
    // Cut anywhere but between two instructions.
    unsigned char begins[sizeof blocks / 4 + 1] = {0};
    const size_t count = sizeof blocks / 4;
    for (size_t n = 5; n < count; n += blocks[n] >> 16) {
        begins[n] = 1;
    }
    for (size_t bytes = 20; bytes < sizeof blocks; ++bytes) {
        if (bytes % 4 != 0 || !begins[bytes / 4]) {
            refuse(blocks, bytes);
        }
    }
    uint32_t *words = copy_of(blocks, sizeof blocks);
    words[0] = 0x03022307; // the other byte order
    refuse(words, sizeof blocks);
    words[0] = blocks[0];
    for (size_t n = 5; n < count; ++n) {
        if (begins[n]) {
            words[n] = blocks[n] & 0xffff; // no word at all: a walk would stand still
            refuse(words, sizeof blocks);
            words[n] = blocks[n] | 0xffff0000u; // far beyond the end
            refuse(words, sizeof blocks);
            words[n] = blocks[n];
        }
    }
    // Instructions too short for their operands, at the very end.
    const uint32_t short_ones[][2] = {{71, 2}, {72, 3}, {32, 3}, {59, 3}};
    for (size_t n = 0; n < sizeof short_ones / sizeof *short_ones; ++n) {
        uint32_t tiny[5 + 3] = {0x07230203, 0x00010300, 0, 20, 0};
        tiny[5] = OP(short_ones[n][1], short_ones[n][0]);
        refuse(tiny, (5 + short_ones[n][1]) * 4);
    }
    const uint32_t no_set[] = {0x07230203, 0x00010300, 0, 20, 0, OP(3, 71), 12, 34};
    refuse(no_set, sizeof no_set);
    const uint32_t no_offset[] = {0x07230203, 0x00010300, 0, 20, 0, OP(4, 72), 2, 0, 35};
    refuse(no_offset, sizeof no_offset);
    free(words);
}

#ifdef SPIRV_VAL
static void check_valid(const module *m, const uint32_t *words) {
    FILE *validator = popen(SPIRV_VAL " --target-env vulkan1.1 -", "w");
    assert_non_null(validator);
    const size_t written = fwrite(words, 1, m->bytes, validator);
    if (pclose(validator) != 0 || written != m->bytes) {
        fail_msg("spirv-val refuses %s", m->name);
    }
}
#endif

static void validator_accepts(void **state) {
    (void)state;
#ifdef SPIRV_VAL
    for (size_t n = 0; n < MODULE_COUNT; ++n) {
        for (size_t turn = 0; turn < MOVE_COUNT; turn += MOVE_COUNT - 1) {
            uint32_t *moved = copy_of(modules[n].words, modules[n].bytes);
            assert_true(girih_spirv_place(moved, modules[n].bytes, moves[turn].set,
                                          moves[turn].push_offset));
            check_valid(&modules[n], moved);
            free(moved);
        }
    }
#else
    skip(); // built without spirv-val
#endif
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shaders_move),      cmocka_unit_test(moves_add_up),
        cmocka_unit_test(blocks_move_alone), cmocka_unit_test(malformed_modules),
        cmocka_unit_test(validator_accepts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
