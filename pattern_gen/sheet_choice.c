// The part of sheets that draws nothing.
#include "sheet.h"

#include <ctype.h>
#include <inttypes.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "error.h"

// Reads "i,j,k" and moves *text behind it.
static bool read_levels(const char **text, uint32_t levels[3]) {
    for (int edge = 0; edge < 3; edge++) {
        if (edge > 0 && *(*text)++ != ',') {
            return false;
        }
        if (!isdigit((unsigned char)**text)) {
            return false;
        }
        char *end = NULL;
        const unsigned long value = strtoul(*text, &end, 10);
        if (end - *text > 9) {
            return false;
        }
        levels[edge] = (uint32_t)value;
        *text = end;
    }
    return true;
}

static girih_result find_rank(const girih_catalogue *catalogue, const uint32_t levels[3],
                              uint32_t *rank, girih_error *error) {
    const uint32_t first = catalogue->spacing == GIRIH_SPACING_LINEAR ? 1 : 0;
    if (levels[0] > catalogue->max || levels[1] > levels[0] || levels[2] > levels[1] ||
        levels[2] < first) {
        return girih_fail(error, GIRIH_ERROR_INVALID_DATA,
                          "no pattern [%" PRIu32 ",%" PRIu32 ",%" PRIu32
                          "]; it has i >= j >= k from %" PRIu32 " to %" PRIu32,
                          levels[0], levels[1], levels[2], first, catalogue->max);
    }
    *rank = girih_pattern_rank((uint32_t[3]){levels[0] - first, levels[1] - first, levels[2] - first});
    return GIRIH_OK;
}

static girih_result choose_some(girih_sheet *sheet, const girih_catalogue *catalogue,
                                const char *choice, girih_error *error) {
    for (const char *text = choice;;) {
        uint32_t levels[3];
        if (!read_levels(&text, levels) || (*text && *text != ';')) {
            return girih_fail(error, GIRIH_ERROR_INVALID_ARGUMENT,
                              "--patterns is a list such as '4,2,1;3,3,3', not '%.200s'", choice);
        }
        girih_result result = find_rank(catalogue, levels, &sheet->ranks[sheet->count], error);
        if (result != GIRIH_OK) {
            return result;
        }
        sheet->count++;
        if (!*text) {
            return GIRIH_OK;
        }
        text++;
    }
}

girih_result girih_sheet_choose(girih_sheet *sheet, const girih_catalogue *catalogue,
                                const char *choice, girih_error *error) {
    *sheet = (girih_sheet){.count = 0};
    const size_t most = choice ? strlen(choice) / strlen("0,0,0") + 1 : catalogue->pattern_count;
    sheet->ranks = calloc(most, sizeof *sheet->ranks);
    if (!sheet->ranks) {
        return girih_fail(error, GIRIH_ERROR_OUT_OF_MEMORY, "no memory for %zu patterns", most);
    }
    if (choice) {
        return choose_some(sheet, catalogue, choice, error);
    }
    while (sheet->count < catalogue->pattern_count) {
        sheet->ranks[sheet->count] = sheet->count;
        sheet->count++;
    }
    return GIRIH_OK;
}

void girih_sheet_free(girih_sheet *sheet) {
    free(sheet->ranks);
    sheet->ranks = NULL;
}
