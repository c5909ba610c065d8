// girih: adaptive, crack-free tessellation of triangle meshes on Vulkan.
// Stability: stable, but for what the headers mark as experimental
#ifndef GIRIH_GIRIH_H
#define GIRIH_GIRIH_H

#include "girih/catalogue.h"
#include "girih/context.h"
#include "girih/cpu.h"
#include "girih/mesh.h"
#include "girih/plan.h"
#include "girih/result.h"
#include "girih/surface.h"
#include "girih/version.h"

#endif
