#include "reproject/sheets/sheet_mesh.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

#include "core/memory.h"
#include "core/new_memory.h"
#include "core/threads.h"
#include "reproject/sheets/sheet_builder.h"
#include "reproject/sheets/sheet_keys.h"

namespace postlens {
namespace {

std::uint32_t relocated(std::uint32_t node, std::uint32_t first_node, std::uint32_t first_texel) {
    if (SheetNode::empty(node)) return node;
    return (node & SheetNode::leaf) != 0 ? node + first_texel : node + first_node;
}

struct Before {
    std::size_t sheets = 0, cells = 0, nodes = 0, texels = 0, bright = 0, bright_texels = 0;
};

/// Limit of the size of a joined list, in bytes. Parallel tasks build lists, which are joined and then freed.
/// If the joined list is larger than this limit, the freed memory is returned to the system at once. For
/// smaller lists, this would only cost time.
constexpr std::size_t much_bytes = std::size_t{48} << 20;

/// Joins the meshes that several parallel tasks have built into one mesh, `out`. The lists of the tasks are
/// then freed. Elements of the lists refer to each other by indices, which start at 0 in each task.
/// Therefore, the indices are renumbered.
template <typename Made>
void join(std::size_t tasks, const Made& made, SheetMesh& out) {
    std::vector<Before> before(tasks + 1);
    bool any_below = false;
    for (std::size_t t = 0; t < tasks; ++t) {
        const SheetMesh& m = made(t);
        const Before& b = before[t];
        before[t + 1] = {b.sheets + m.sheets.size(), b.cells + m.fine.size(),
                         b.nodes + m.nodes.size(),   b.texels + m.texels.size(),
                         b.bright + m.bright.size(), b.bright_texels + m.bright_texels.size()};
        any_below = any_below || !m.below.empty();
    }
    const auto each = [&](auto SheetMesh::*list, std::size_t Before::*first, std::size_t per_entry,
                          const auto& changed) {
        auto& to = out.*list;
        resize_by_all(to, before[tasks].*first * per_entry);
        parallel_for(tasks, [&](std::size_t t) {
            auto& from = made(t).*list;
            std::transform(from.begin(), from.end(),
                           to.begin() + static_cast<std::ptrdiff_t>(before[t].*first * per_entry),
                           [&](const auto& entry) { return changed(entry, before[t]); });
            from = std::remove_reference_t<decltype(from)>();  // `{}` would keep its memory
        });
        if (to.size() * sizeof(to[0]) > much_bytes) give_back_memory();
    };
    const auto moved_node = [](std::uint32_t node, const Before& b) {
        return relocated(node, static_cast<std::uint32_t>(b.nodes), static_cast<std::uint32_t>(b.texels));
    };
    const auto same = [](const auto& entry, const Before&) { return entry; };
    each(&SheetMesh::sheets, &Before::sheets, 1, [](Sheet s, const Before& b) {
        s.first_cell += static_cast<std::uint32_t>(b.cells);
        return s;
    });
    each(&SheetMesh::fine, &Before::cells, 1, moved_node);
    each(&SheetMesh::coarse, &Before::cells, 1, moved_node);
    each(&SheetMesh::planes, &Before::cells, out.values, same);
    if (out.has_w()) each(&SheetMesh::bends, &Before::cells, 1, same);
    each(&SheetMesh::nodes, &Before::nodes, 1, moved_node);
    each(&SheetMesh::texels, &Before::texels, 1, [](Texel t, const Before& b) {
        t.info += static_cast<std::uint32_t>(b.sheets) << Texel::sheet_shift;
        return t;
    });
    each(&SheetMesh::bright, &Before::bright, 1, [](Highlight h, const Before& b) {
        h.sheet += static_cast<std::uint32_t>(b.sheets);
        return h;
    });
    each(&SheetMesh::bright_texels, &Before::bright_texels, 1, [](BrightTexel t, const Before& b) {
        t.texel += static_cast<std::uint32_t>(b.texels);
        t.first_light += static_cast<std::uint32_t>(b.bright);
        return t;
    });
    if (any_below) each(&SheetMesh::below, &Before::texels, 1, same);
}

constexpr int edge = SheetMesh::square_px;

/// A row of raster squares (16 x 16 px): the quadtrees of its pixels, the rays through the corners of the
/// quadtree cells, and the surfaces that these rays hit.
struct Strip {
    int y = 0, y_end = 0;
    PixelLeaves leaves;
    SampleTrees primary, deeper;
    SheetKeys primary_keys, deeper_keys;

    void find(const RecordBand& band, float bright_above) {
        find_leaves(band, y, y_end, leaves);
        find_trees(band, leaves.points, y, bright_above, primary, deeper);
        find_sheet_keys(primary, primary_keys);
        find_sheet_keys(deeper, deeper_keys);
    }
};

void clear(SheetMesh& m) {
    m.sheets.clear();
    m.fine.clear();
    m.coarse.clear();
    m.planes.clear();
    m.bends.clear();
    m.nodes.clear();
    m.texels.clear();
    m.below.clear();
    m.bright.clear();
    m.bright_texels.clear();
    m.highlights.clear();
}

/// Returns how many strips (groups of 16 raster rows) are read from the file together, from the raster row y
/// on. There must be enough strips for all threads, but their records must fit into a cache of the processor.
std::size_t strips_at_once(const SampleFileReader& file, std::size_t instant, int y,
                           const SheetChoice& choice) {
    constexpr std::size_t most = 64;
    const std::size_t least = std::clamp<std::size_t>(static_cast<std::size_t>(thread_count()), 4, most);
    constexpr std::uint64_t enough = 1U << 16U, too_many = 1U << 20U;
    const auto rows = file.scanlines(instant).subspan(static_cast<std::size_t>(y - file.y_begin()));
    std::uint64_t records = 0;
    std::size_t strips = 0;
    for (std::size_t row = 0; row + 1 < rows.size() && strips < most; ++strips) {
        if (records >= (strips >= least ? enough : too_many)) break;
        if (choice.rows && !choice.rows(y + static_cast<int>(strips) * edge)) break;
        for (int i = 0; i < edge && row + 1 < rows.size(); ++i) records += rows[row++].records;
    }
    return strips;
}

}  // namespace

TreeSheets tree_sheets(const SampleFileReader& file, std::size_t instant, const HighlightRule& rule,
                       const RecordsRead& also, const SheetChoice& choice) {
    constexpr std::size_t bytes_of_record =
        2 * sizeof(Texel) + 2 * sizeof(std::uint32_t) + 2 * sizeof(CellPlane);
    if (!choice.squares) {
        require_memory(file.record_count() * bytes_of_record, "the sheets of the light field");
    }
    const SampleHeader& h = file.header();
    RecordBand band;
    std::vector<Strip> strips;
    std::vector<TreeSheets> parts;
    constexpr int squares_per_task = SheetChoice::squares_per_part;
    const int width = file.x_end() - file.x_begin() - 1;
    const int squares = (width + edge - 1) / edge;
    const auto tasks_per_strip =
        static_cast<std::size_t>((squares + squares_per_task - 1) / squares_per_task);
    for (int y = file.y_begin(); y < file.y_end() - 1;) {
        const std::size_t count = strips_at_once(file, instant, y, choice);
        if (count == 0) {
            if (choice.known) choice.known(parts, y);
            y += edge;
            continue;
        }
        if (strips.size() < count) strips.resize(count);
        const int y_first = y;
        for (std::size_t s = 0; s < count; ++s, y = strips[s - 1].y_end) {
            strips[s].y = y;
            strips[s].y_end = std::min(y + edge, file.y_end() - 1);
        }
        file.read(y_first, y + 1, band, instant);
        // Passes the rows to the caller's function `also.rows`, which must get each raster row once. The row
        // `y` is the last row of these strips and the first row of the next ones. Therefore, it is passed now
        // only if the file ends with it.
        if (also.rows) also.rows(band, y_first, y + 1 == file.y_end() ? y + 1 : y);
        parallel_for(count, [&](std::size_t s) {
            Strip& strip = strips[s];
            strip.find(band, rule.above);
            if (also.leaves) also.leaves(band, strip.y, strip.y_end, strip.leaves);
        });
        const std::size_t first_part = parts.size();
        parts.resize(first_part + count * tasks_per_strip);
        parallel_for(count * tasks_per_strip, [&](std::size_t t) {
            const Strip& strip = strips[t / tasks_per_strip];
            thread_local TreeSheets made;  // keeps its capacity between tasks
            clear(made.primary);
            clear(made.deeper);
            made.deeper.values = 5;
            const auto build = [&](const SampleTrees& trees, const SheetKeys& keys, SheetMesh& mesh) {
                if (trees.nodes.empty()) return;
                SheetBuilder builder(strip.leaves, trees, keys, h, rule, mesh);
                const int first = static_cast<int>(t % tasks_per_strip) * squares_per_task;
                for (int k = first; k < std::min(first + squares_per_task, squares); ++k) {
                    builder.build({.first_pixel = k * edge,
                                   .last_pixel = std::min((k + 1) * edge, width),
                                   .rows = strip.y_end - strip.y,
                                   .band_width = band.width(),
                                   .x = band.x_begin + k * edge,
                                   .y = strip.y});
                }
            };
            build(strip.primary, strip.primary_keys, made.primary);
            if (choice.deeper) build(strip.deeper, strip.deeper_keys, made.deeper);
            // Each thread has only one `made`. It is copied before the call of `choice.squares`, because this
            // function may wait for a parallel loop of its own. During the wait, the thread may run another
            // task of the present loop, which would overwrite `made`.
            TreeSheets& part = parts[first_part + t];
            part = made;
            if (choice.squares) choice.squares(part, strip.y, t % tasks_per_strip);
        });
    }
    band = RecordBand();
    strips = std::vector<Strip>();
    TreeSheets out;
    out.primary.time_s = out.deeper.time_s = file.instant_s(instant);
    out.deeper.values = 5;
    join(
        parts.size(), [&](std::size_t t) -> SheetMesh& { return parts[t].primary; }, out.primary);
    join(
        parts.size(), [&](std::size_t t) -> SheetMesh& { return parts[t].deeper; }, out.deeper);
    take_highlights(out, rule);
    return out;
}

std::vector<BrightSheet> bright_sheets(const SheetMesh& mesh) {
    std::vector<BrightSheet> out(mesh.sheets.size());
    for (const Highlight& light : mesh.bright) {
        BrightSheet& sheet = out[light.sheet];
        sheet.area_px2 += light.area;
        sheet.hides = std::max(sheet.hides, light.hides);
    }
    return out;
}

void take_highlights(TreeSheets& sheets, const HighlightRule& rule) {
    for (SheetMesh* mesh : {&sheets.primary, &sheets.deeper}) {
        std::vector<std::uint8_t> taken(mesh->bright.size(), 0);
        mesh->highlights.clear();
        const std::vector<BrightSheet> bright = bright_sheets(*mesh);
        for (std::size_t i = 0; rule.takes && i < taken.size(); ++i) {
            const Highlight& light = mesh->bright[i];
            const SheetKey& key = mesh->sheets[light.sheet].key;
            if (!rule.takes(light, key, bright[light.sheet])) continue;
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
