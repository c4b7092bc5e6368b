// The sheets of a file of random quadtrees.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <random>

#include "records/sample_file.h"
#include "reproject/patches/patch_raster.h"
#include "reproject/sheets/sheet_mesh.h"
#include "tests/support/random_records.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test {

/// The size of the image and its overscan, px.
inline constexpr int width = 40, height = 30, overscan = 3;

/// The sheets of a file of random quadtrees, whose records are modified by `change`.
struct MadeSheets {
    template <typename Change>
    MadeSheets(const RandomOptions& options, const Change& change, std::uint32_t seed = 3) {
        std::mt19937 random(seed);
        SampleHeader h = full_header(width, height, overscan, options);
        h.film_distance_mm = 50;
        h.pixel_pitch_mm = 36.0 / width;
        band = random_frame(random, h, options);
        for (Record& r : band.records) {
            if (!options.has_w) r.path = NodePath();
            change(r);
            if (r.path.bits() == 0) r.w = Mat2::isotropic(1 / r.z);
        }
        const std::filesystem::path path = folder.path() / "made.exr";
        SampleFileWriter writer(path, h, RecordCompression::none);
        writer.write(band);
        writer.finish();
        file = std::make_unique<SampleFileReader>(path);
        sheets = tree_sheets(*file, 0, {});
    }
    TemporaryFolder folder;
    RecordBand band;
    std::unique_ptr<SampleFileReader> file;
    TreeSheets sheets;
};

/// The texel at position (x, y) in [0, 1) px of a pixel; `no_texel` where the sheet is empty.
inline std::uint32_t texel_at(const SheetMesh& mesh, std::uint32_t node, double x, double y) {
    while (!SheetNode::empty(node) && (node & SheetNode::leaf) == 0) {
        x *= 2;
        y *= 2;
        const bool right = x >= 1, down = y >= 1;
        node = mesh.nodes[node + (right ? 1U : 0U) + (down ? 2U : 0U)];
        if (right) x -= 1;
        if (down) y -= 1;
    }
    return SheetNode::empty(node) ? SeenTile::no_texel : node & ~SheetNode::leaf;
}

}  // namespace postlens::test
