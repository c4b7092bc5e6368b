#include "planner/views/tile_grid.h"

#include "reproject/patches/patch_raster.h"

namespace postlens {

static_assert(TileGrid::edge == SeenTile::edge,
              "what is wanted of the light field is asked for tile by tile");

}  // namespace postlens
