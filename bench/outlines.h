// Triangles as lines: which pattern a method has made can be seen, and drawn at any size.
#ifndef GIRIH_BENCH_OUTLINES_H
#define GIRIH_BENCH_OUTLINES_H

#include "target.h"

// Writes an SVG of those triangles that face the viewer. Their winding says which do.
girih_result bench_outlines_write(const char *path, const bench_triangles *triangles,
                                  const bench_view *view, girih_error *error);

#endif
