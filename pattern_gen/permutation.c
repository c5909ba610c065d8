#include "permutation.h"

#include <inttypes.h>

#include "error.h"

#define LEVELS 9u
#define TRIPLES (LEVELS * LEVELS * LEVELS)

static const uint8_t all_corners[6][3] = {
    {0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0},
};

static void swap(uint32_t *a, uint32_t *b) {
    uint32_t kept = *a;
    *a = *b;
    *b = kept;
}

uint32_t girih_permutation_sort(uint32_t levels[3]) {
    uint32_t lambda = 0;
    if (levels[0] < levels[1]) {
        swap(&levels[0], &levels[1]);
        lambda += 1;
    }
    if (levels[0] < levels[2]) {
        swap(&levels[0], &levels[2]);
        lambda += 2;
    }
    if (levels[1] < levels[2]) {
        swap(&levels[1], &levels[2]);
        lambda += 4;
    }
    return lambda;
}

static void triple(uint32_t number, uint32_t levels[3]) {
    levels[0] = number / (LEVELS * LEVELS);
    levels[1] = number / LEVELS % LEVELS;
    levels[2] = number % LEVELS;
}

// The input's edge between two of its corners; edge n joins the corners n and n + 1.
static uint8_t edge_between(uint8_t a, uint8_t b) {
    return (uint8_t)((a + 1) % 3 == b ? a : b);
}

// Whether the permuted triangle's edges carry the sorted levels.
static bool serves(const uint8_t corners[3], const uint32_t levels[3], const uint32_t sorted[3]) {
    for (int n = 0; n < 3; n++) {
        if (levels[edge_between(corners[n], corners[(n + 1) % 3])] != sorted[n]) {
            return false;
        }
    }
    return true;
}

static bool is_odd(const uint8_t corners[3]) {
    return (corners[0] + 1) % 3 != corners[1];
}

// Which triples of levels a search is about.
typedef bool filter(uint32_t lambda, const uint32_t sorted[3]);

static bool all(uint32_t lambda, const uint32_t sorted[3]) {
    (void)lambda;
    (void)sorted;
    return true;
}

static bool tied(uint32_t lambda, const uint32_t sorted[3]) {
    (void)lambda;
    return sorted[0] == sorted[1] || sorted[1] == sorted[2];
}

static bool equal_ij(uint32_t lambda, const uint32_t sorted[3]) {
    (void)lambda;
    return sorted[0] == sorted[1];
}

static bool equal_jk(uint32_t lambda, const uint32_t sorted[3]) {
    (void)lambda;
    return sorted[1] == sorted[2];
}

// Whether these corners serve every triple that gives this lambda and passes the filter; *seen
// counts those triples. With `table`, lambda is the one after the tie rule.
static bool serves_all(const uint8_t corners[3], uint32_t lambda, filter *passes,
                       const girih_permutation *table, uint32_t *seen) {
    *seen = 0;
    for (uint32_t number = 0; number < TRIPLES; number++) {
        uint32_t levels[3];
        uint32_t sorted[3];
        triple(number, levels);
        triple(number, sorted);
        uint32_t found = girih_permutation_sort(sorted);
        if (table && tied(found, sorted)) {
            found = table[found].even;
        }
        if (found == lambda && passes(found, sorted)) {
            ++*seen;
            if (!serves(corners, levels, sorted)) {
                return false;
            }
        }
    }
    return true;
}

// The lambda of the given parity, lowest first, whose corners serve as well in all such triples;
// lambda itself where there is no such triple, GIRIH_LAMBDA_COUNT where none serves.
static uint8_t find_other(const girih_permutation *table, uint32_t lambda, bool odd, filter *passes,
                          const girih_permutation *after_ties) {
    for (uint8_t other = 0; other < GIRIH_LAMBDA_COUNT; other++) {
        uint32_t seen = 0;
        if (other != 3 && table[other].odd == odd &&
            serves_all(table[other].corners, lambda, passes, after_ties, &seen)) {
            return seen > 0 ? other : (uint8_t)lambda;
        }
    }
    return GIRIH_LAMBDA_COUNT;
}

girih_result girih_permutation_derive(girih_permutation table[GIRIH_LAMBDA_COUNT],
                                      girih_error *error) {
    for (uint32_t lambda = 0; lambda < GIRIH_LAMBDA_COUNT; lambda++) {
        // Every swap of Figure 8 turns the parity over; with two levels equal this decides between
        // the two permutations that serve.
        bool odd = ((lambda & 1) + (lambda >> 1 & 1) + (lambda >> 2 & 1)) % 2 != 0;
        int candidates = 0;
        uint32_t seen = 0;
        girih_permutation *entry = &table[lambda];
        *entry = (girih_permutation){.corners = {0, 1, 2}};
        for (int n = 0; n < 6; n++) {
            const uint8_t *corners = all_corners[n];
            if (is_odd(corners) == odd && serves_all(corners, lambda, all, NULL, &seen) &&
                seen > 0) {
                *entry = (girih_permutation){.corners = {corners[0], corners[1], corners[2]}};
                candidates++;
            }
        }
        if (candidates != (lambda == 3 ? 0 : 1)) {
            return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                              "%d corner permutations serve lambda %" PRIu32 ", expected one",
                              candidates, lambda);
        }
        entry->odd = candidates == 1 && odd;
        for (int n = 0; n < 3; n++) {
            entry->edges[n] = edge_between(entry->corners[n], entry->corners[(n + 1) % 3]);
        }
    }
    for (uint32_t lambda = 0; lambda < GIRIH_LAMBDA_COUNT; lambda++) {
        girih_permutation *entry = &table[lambda];
        entry->even = entry->odd ? find_other(table, lambda, false, tied, NULL) : (uint8_t)lambda;
    }
    for (uint32_t lambda = 0; lambda < GIRIH_LAMBDA_COUNT; lambda++) {
        girih_permutation *entry = &table[lambda];
        bool even = !entry->odd;
        entry->odd_ij =
            even ? find_other(table, lambda, true, equal_ij, table) : (uint8_t)lambda;
        entry->odd_jk =
            even ? find_other(table, lambda, true, equal_jk, table) : (uint8_t)lambda;
        if (entry->even == GIRIH_LAMBDA_COUNT || entry->odd_ij == GIRIH_LAMBDA_COUNT ||
            entry->odd_jk == GIRIH_LAMBDA_COUNT) {
            return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                              "no lambda serves ties of lambda %" PRIu32, lambda);
        }
    }
    return GIRIH_OK;
}

static void emit_macro(FILE *stream, const char *name, uint32_t packed, uint32_t bits) {
    fprintf(stream,
            "#define GIRIH_LAMBDA_%s(lambda) (0x%0*" PRIx32 "u >> (%uu * (lambda)) & %uu)\n", name,
            (int)(2 * bits), packed, bits, (1u << bits) - 1);
}

void girih_permutation_emit(const girih_permutation table[GIRIH_LAMBDA_COUNT], FILE *stream) {
    uint32_t corners[3] = {0, 0, 0};
    uint32_t edges[3] = {0, 0, 0};
    uint32_t odd = 0;
    uint32_t even = 0;
    uint32_t odd_ij = 0;
    uint32_t odd_jk = 0;
    for (uint32_t lambda = 0; lambda < GIRIH_LAMBDA_COUNT; lambda++) {
        const girih_permutation *entry = &table[lambda];
        for (int n = 0; n < 3; n++) {
            corners[n] |= (uint32_t)entry->corners[n] << 2 * lambda;
            edges[n] |= (uint32_t)entry->edges[n] << 2 * lambda;
        }
        odd |= (uint32_t)entry->odd << lambda;
        even |= (uint32_t)entry->even << 3 * lambda;
        odd_ij |= (uint32_t)entry->odd_ij << 3 * lambda;
        odd_jk |= (uint32_t)entry->odd_jk << 3 * lambda;
    }
    fputs("// Written by `girih-patterns emit-permutation`, which finds it by search. For C and\n"
          "// GLSL alike: lambda is a uint32_t in C, a uint in GLSL, in 0..7.\n"
          "//\n"
          "// lambda (ARKFPI, Lenz, Cavalcante-Neto, Vidal 2009, Figure 8) says how the levels\n"
          "// (i, j, k) of the edges P1P2, P2P3, P3P1 are sorted to i >= j >= k: lambda = 0; if\n"
          "// i < j swap them, lambda += 1; if i < k swap them, lambda += 2; if j < k swap them,\n"
          "// lambda += 4. 3 cannot occur.\n"
          "#ifndef GIRIH_PERMUTATION_H\n"
          "#define GIRIH_PERMUTATION_H\n"
          "\n"
          "// The input's corner, 0..2 for P1..P3, that is corner 1, 2 and 3 of the sorted\n"
          "// triangle Q1 Q2 Q3. A base-pattern vertex (u, v, w) lies at Q1 u + Q2 v + Q3 w.\n",
          stream);
    emit_macro(stream, "CORNER_1", corners[0], 2);
    emit_macro(stream, "CORNER_2", corners[1], 2);
    emit_macro(stream, "CORNER_3", corners[2], 2);
    fputs("\n"
          "// The three in one value: corner 1 in the bits 0 and 1, corner 2 in 2 and 3, corner 3\n"
          "// in 4 and 5.\n"
          "#define GIRIH_LAMBDA_CORNERS(lambda) \\\n"
          "    (GIRIH_LAMBDA_CORNER_1(lambda) | GIRIH_LAMBDA_CORNER_2(lambda) << 2u | \\\n"
          "     GIRIH_LAMBDA_CORNER_3(lambda) << 4u)\n"
          "\n"
          "// The input's edge, 0..2 for P1P2, P2P3, P3P1, that is edge Q1Q2, Q2Q3 and Q3Q1.\n",
          stream);
    emit_macro(stream, "EDGE_1", edges[0], 2);
    emit_macro(stream, "EDGE_2", edges[1], 2);
    emit_macro(stream, "EDGE_3", edges[2], 2);
    fputs("\n// The three in one value, packed as the corners are.\n"
          "#define GIRIH_LAMBDA_EDGES(lambda) \\\n"
          "    (GIRIH_LAMBDA_EDGE_1(lambda) | GIRIH_LAMBDA_EDGE_2(lambda) << 2u | \\\n"
          "     GIRIH_LAMBDA_EDGE_3(lambda) << 4u)\n"
          "\n"
          "// Bit lambda is set where the permutation is odd: it mirrors the pattern, so its\n"
          "// triangles must be turned over, (a, b, c) to (a, c, b), to wind as P1, P2, P3.\n",
          stream);
    fprintf(stream, "#define GIRIH_LAMBDA_ODD 0x%02" PRIx32 "u\n", odd);
    fputs("#define GIRIH_LAMBDA_IS_ODD(lambda) (GIRIH_LAMBDA_ODD >> (lambda) & 1u)\n"
          "\n"
          "// The tie rule. Only where two or three of the levels are equal: the even lambda that\n"
          "// serves as well.\n",
          stream);
    emit_macro(stream, "EVEN", even, 3);
    fputs("\n"
          "// Of an even lambda: the odd one that serves as well, only where the sorted levels\n"
          "// have i == j, and only where they have j == k. For transforms that mirror.\n",
          stream);
    emit_macro(stream, "ODD_IJ", odd_ij, 3);
    emit_macro(stream, "ODD_JK", odd_jk, 3);
    fputs("\n#endif\n", stream);
}
