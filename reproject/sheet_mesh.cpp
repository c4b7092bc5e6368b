#include "reproject/sheet_mesh.h"

#include <algorithm>
#include <cmath>

#include "core/memory.h"
#include "core/threads.h"
#include "reproject/sheet_builder.h"

namespace postlens {
namespace {

template <typename T>
void move_all(const std::vector<T>& from, std::vector<T>& to) {
    to.insert(to.end(), from.begin(), from.end());
}

std::uint32_t relocated(std::uint32_t node, std::uint32_t first_node, std::uint32_t first_texel) {
    if (node == SheetNode::none) return node;
    return (node & SheetNode::leaf) != 0 ? node + first_texel : node + first_node;
}

/// Adds what one task has made, numbered from 0, to the whole.
void append(const SheetMesh& part, SheetMesh& mesh) {
    const auto cells = static_cast<std::uint32_t>(mesh.fine.size());
    const auto nodes = static_cast<std::uint32_t>(mesh.nodes.size());
    const auto texels = static_cast<std::uint32_t>(mesh.texels.size());
    const auto sheets = static_cast<std::uint32_t>(mesh.sheets.size());
    for (Sheet s : part.sheets) {
        s.first_cell += cells;
        mesh.sheets.push_back(s);
    }
    for (const std::uint32_t n : part.fine) mesh.fine.push_back(relocated(n, nodes, texels));
    for (const std::uint32_t n : part.coarse) mesh.coarse.push_back(relocated(n, nodes, texels));
    for (const std::uint32_t n : part.nodes) mesh.nodes.push_back(relocated(n, nodes, texels));
    for (Texel t : part.texels) {
        t.info += sheets << 2U;
        mesh.texels.push_back(t);
    }
    for (BrightTexel b : part.bright_texels) {
        b.texel += texels;
        b.first_light += static_cast<std::uint32_t>(mesh.bright.size());
        mesh.bright_texels.push_back(b);
    }
    for (Highlight h : part.bright) {
        h.sheet += sheets;
        mesh.bright.push_back(h);
    }
    move_all(part.planes, mesh.planes);
    if (!part.below.empty() && mesh.below.empty()) mesh.below.resize(texels);
    move_all(part.below, mesh.below);
    if (!mesh.below.empty()) mesh.below.resize(mesh.texels.size());
}

}  // namespace

TreeSheets tree_sheets(const SampleFileReader& file, std::size_t instant, const HighlightRule& rule) {
    constexpr std::size_t bytes_of_record = 2 * sizeof(Texel) + 2 * sizeof(std::uint32_t) + 2 * sizeof(Plane);
    require_memory(file.record_count() * bytes_of_record, "the sheets of the light field");
    TreeSheets out;
    out.deeper.values = 5;
    const SampleHeader& h = file.header();
    RecordBand band;
    PixelLeaves leaves;
    SampleTrees primary, deeper;
    constexpr int edge = SheetMesh::square_px;
    constexpr int squares_per_task = 8;
    for (int y = file.y_begin(); y < file.y_end() - 1; y += edge) {
        const int y_end = std::min(y + edge, file.y_end() - 1);
        file.read(y, y_end + 1, band, instant);
        find_leaves(band, y, y_end, leaves);
        find_trees(band, leaves.points, y, primary, deeper);
        const int width = band.width() - 1;
        const int squares = (width + edge - 1) / edge;
        const auto tasks = static_cast<std::size_t>((squares + squares_per_task - 1) / squares_per_task);
        std::vector<TreeSheets> parts(tasks);
        parallel_for(tasks, [&](std::size_t t) {
            parts[t].deeper.values = 5;
            const auto build = [&](const SampleTrees& trees, SheetMesh& mesh) {
                if (trees.nodes.empty()) return;
                SheetBuilder builder(leaves, trees, h, rule, mesh);
                const int first = static_cast<int>(t) * squares_per_task;
                for (int k = first; k < std::min(first + squares_per_task, squares); ++k) {
                    builder.build({.first_pixel = k * edge,
                                   .last_pixel = std::min((k + 1) * edge, width),
                                   .rows = y_end - y,
                                   .band_width = band.width(),
                                   .x = band.x_begin + k * edge,
                                   .y = y});
                }
            };
            build(primary, parts[t].primary);
            build(deeper, parts[t].deeper);
        });
        for (const TreeSheets& part : parts) {
            append(part.primary, out.primary);
            append(part.deeper, out.deeper);
        }
    }
    take_highlights(out, rule);
    return out;
}

void take_highlights(TreeSheets& sheets, const HighlightRule& rule) {
    for (SheetMesh* mesh : {&sheets.primary, &sheets.deeper}) {
        std::vector<std::uint8_t> taken(mesh->bright.size(), 0);
        mesh->highlights.clear();
        for (std::size_t i = 0; rule.blurs && i < taken.size(); ++i) {
            const Highlight& light = mesh->bright[i];
            const SheetKey& key = mesh->sheets[light.sheet].key;
            if (!rule.blurs(light.w, key.path.bits() == 0 ? key.id : key.parent_id)) continue;
            taken[i] = 1;
            mesh->highlights.push_back(light);
        }
        for (const BrightTexel& b : mesh->bright_texels) {
            std::array<float, 3> rgb = b.rgb;
            for (std::uint32_t i = b.first_light; i < b.first_light + b.lights; ++i) {
                if (taken[i] != 0) continue;
                for (std::size_t c = 0; c < 3; ++c) rgb[c] += mesh->bright[i].rgb[c] / b.area;
            }
            Texel& to = mesh->texels[b.texel];
            to.r = rgb[0];
            to.g = rgb[1];
            to.b = rgb[2];
        }
    }
}

}  // namespace postlens
