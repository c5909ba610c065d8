// What the colours of a picture say, as a panel of its overlay.
#ifndef GIRIH_VIEWER_LEGEND_H
#define GIRIH_VIEWER_LEGEND_H

#include "renderer.h"

// Adds the legend of a way to shade to a corner of an area: of levels and patterns those that the
// plan used when it was last refined (NULL: all of the catalogue's levels, and no pattern by name).
// GIRIH_SHADE_LIT needs none. *fits, which may be NULL, says whether the area had room for it.
girih_result girih_legend_add(girih_overlay *overlay, girih_shade shade,
                              const girih_catalogue *catalogue, const girih_plan *plan,
                              girih_corner corner, const girih_rectangle *area, bool *fits,
                              girih_error *error);

#endif
