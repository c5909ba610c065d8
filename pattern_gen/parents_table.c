#include "parents_table.h"

#include <pthread.h>
#include <unistd.h>

#include "error.h"
#include "parents.h"

#define MOST_THREADS 64

typedef struct table {
    const girih_catalogue *catalogue;
    uint32_t *parents;
    pthread_mutex_t mutex; // of what follows
    uint32_t next;         // rank
    girih_result result;
    girih_error error;
} table;

uint32_t girih_coarser_rank(const girih_base_pattern *pattern) {
    const uint32_t levels[3] = {pattern->levels[0], pattern->levels[1], pattern->levels[2]};
    uint32_t coarser[3];
    girih_coarser_levels(levels, coarser);
    return girih_pattern_rank(coarser);
}

static girih_result find_parents(const table *t, uint32_t rank, girih_error *error) {
    const girih_base_pattern *entry = girih_catalogue_pattern(t->catalogue, rank);
    girih_pattern fine;
    girih_pattern coarse = {.vertex_count = 0};
    girih_result result = girih_pattern_read(t->catalogue, rank, &fine, error);
    if (result == GIRIH_OK) {
        result = girih_pattern_read(t->catalogue, girih_coarser_rank(entry), &coarse, error);
    }
    if (result == GIRIH_OK) {
        result = girih_parents_find(&fine, &coarse, t->parents + entry->first_vertex, error);
    }
    girih_pattern_free(&fine);
    girih_pattern_free(&coarse);
    return result;
}

static void *fill(void *data) {
    table *t = data;
    pthread_mutex_lock(&t->mutex);
    while (t->result == GIRIH_OK && t->next < t->catalogue->pattern_count) {
        const uint32_t rank = t->next++;
        pthread_mutex_unlock(&t->mutex);
        girih_error error;
        const girih_result result = find_parents(t, rank, &error);
        pthread_mutex_lock(&t->mutex);
        if (result != GIRIH_OK) {
            t->result = result;
            t->error = error;
        }
    }
    pthread_mutex_unlock(&t->mutex);
    return NULL;
}

girih_result girih_parents_fill(const girih_catalogue *catalogue, uint32_t *parents,
                                girih_error *error) {
    table t = {.catalogue = catalogue,
               .parents = parents,
               .mutex = PTHREAD_MUTEX_INITIALIZER,
               .result = GIRIH_OK};
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    pthread_t threads[MOST_THREADS];
    int count = 0;
    while (count < MOST_THREADS && count + 1 < processors &&
           pthread_create(&threads[count], NULL, fill, &t) == 0) {
        count++;
    }
    fill(&t);
    for (int n = 0; n < count; n++) {
        pthread_join(threads[n], NULL);
    }
    if (t.result != GIRIH_OK && error) {
        *error = t.error;
    }
    return t.result;
}
