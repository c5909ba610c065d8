// Where a SPIR-V module has its descriptors and push constants: moved before the module is made,
// because sets and offsets cannot be specialized (SPIR-V specification, sections 2.3 and 3).
#include "context.h"

enum {
    MAGIC = 0x07230203,
    HEADER_WORDS = 5,
    OP_TYPE_POINTER = 32,    // result, storage class, type
    OP_VARIABLE = 59,        // result type, result, storage class
    OP_DECORATE = 71,        // target, decoration, operands
    OP_MEMBER_DECORATE = 72, // type, member, decoration, operands
    DESCRIPTOR_SET = 34,
    OFFSET = 35,
    PUSH_CONSTANT = 9,
};

static uint32_t opcode_of(const uint32_t *instruction) {
    return instruction[0] & 0xffffu;
}

static uint32_t length_of(const uint32_t *instruction) {
    return instruction[0] >> 16;
}

// Words that an instruction must have at least, so that what is read of it lies in it.
static uint32_t least_length(uint32_t opcode) {
    switch (opcode) {
    case OP_TYPE_POINTER:
    case OP_VARIABLE:
        return 4;
    case OP_DECORATE:
        return 3;
    case OP_MEMBER_DECORATE:
        return 4;
    default:
        return 1;
    }
}

// Whether the words are a module of whole instructions: after this the walks need no checks.
static bool well_formed(const uint32_t *words, size_t count) {
    if (count < HEADER_WORDS || words[0] != MAGIC) {
        return false;
    }
    size_t at = HEADER_WORDS;
    while (at < count) {
        const uint32_t *instruction = words + at;
        const uint32_t length = length_of(instruction);
        if (length < least_length(opcode_of(instruction)) || length > count - at) {
            return false;
        }
        // Of decorations, only these two have an operand that is read.
        if (opcode_of(instruction) == OP_DECORATE && instruction[2] == DESCRIPTOR_SET &&
            length < 4) {
            return false;
        }
        if (opcode_of(instruction) == OP_MEMBER_DECORATE && instruction[3] == OFFSET &&
            length < 5) {
            return false;
        }
        at += length;
    }
    return true;
}

// Whether a push constant variable points to values of a type.
static bool holds_push_constants(const uint32_t *words, size_t count, uint32_t type) {
    for (size_t at = HEADER_WORDS; at < count; at += length_of(words + at)) {
        const uint32_t *pointer = words + at;
        if (opcode_of(pointer) != OP_TYPE_POINTER || pointer[2] != PUSH_CONSTANT ||
            pointer[3] != type) {
            continue;
        }
        // Variables come after their types.
        for (size_t later = at; later < count; later += length_of(words + later)) {
            const uint32_t *variable = words + later;
            if (opcode_of(variable) == OP_VARIABLE && variable[1] == pointer[1] &&
                variable[3] == PUSH_CONSTANT) {
                return true;
            }
        }
    }
    return false;
}

bool girih_spirv_place(uint32_t *words, size_t bytes, uint32_t set, uint32_t push_offset) {
    const size_t count = bytes / sizeof *words;
    if (!words || bytes % sizeof *words != 0 || !well_formed(words, count)) {
        return false;
    }
    for (size_t at = HEADER_WORDS; at < count; at += length_of(words + at)) {
        uint32_t *instruction = words + at;
        if (opcode_of(instruction) == OP_DECORATE && instruction[2] == DESCRIPTOR_SET) {
            instruction[3] += set;
        }
        // Offsets inside a member count from the member's own begin, so only the block's move.
        if (opcode_of(instruction) == OP_MEMBER_DECORATE && instruction[3] == OFFSET &&
            push_offset && holds_push_constants(words, count, instruction[1])) {
            instruction[4] += push_offset;
        }
    }
    return true;
}
