#include "focus/light_field/field_surfaces.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>

#include "core/memory.h"
#include "reproject/sheets/sheet_subset.h"

namespace postlens {
namespace {

/// Upper bound of the distance, in px, at which a highlight's blur kernel may still have light. It is
/// kernel_grows times the radius of the highlight's circle of confusion, plus kernel_margin_px. This is more
/// than needed, because the sizes of kernels may be rounded up.
constexpr double kernel_grows = 2, kernel_margin_px = 8;
/// While a large image is drawn in groups of rows, a surface stays in memory if some lens point sees it
/// farther than this, in px, from the row in which it is recorded. Other surfaces are read from the file for
/// each group.
constexpr double far_px = 64;
/// Largest memory, in bytes, for the surfaces that stay in memory.
constexpr std::size_t most_far_bytes = std::size_t{128} << 20;

template <typename T>
std::size_t bytes_of(const std::vector<T>& list) {
    return list.size() * sizeof(T);
}

std::size_t bytes_of(const SheetMesh& m) {
    return bytes_of(m.sheets) + bytes_of(m.fine) + bytes_of(m.coarse) + bytes_of(m.planes) +
           bytes_of(m.bends) + bytes_of(m.nodes) + bytes_of(m.texels) + bytes_of(m.below) +
           bytes_of(m.bright) + bytes_of(m.bright_texels);
}

std::size_t bytes_of(const PatchMesh& m) {
    return bytes_of(m.patches) + bytes_of(m.planes) + bytes_of(m.follows);
}

/// Returns the surfaces i of `mesh` for which wanted(reaches[i]) is true. reaches[i] is the range of image
/// rows in which surface i may appear from some lens point.
template <typename Reaches, typename Wanted>
SheetMesh chosen(const SheetMesh& mesh, const Reaches& reaches, const Wanted& wanted) {
    std::vector<std::uint8_t> which;
    which.reserve(reaches.size());
    for (const auto& reach : reaches) which.push_back(wanted(reach) ? 1 : 0);
    return sheet_subset(mesh, which);
}

}  // namespace

double surface_bytes_of_record(const SampleFileReader& file, const PatchLens& lens,
                               const HighlightRule& rule) {
    constexpr int edge = SheetMesh::square_px;
    const std::span<const ScanlineFacts> rows = file.scanlines(0);
    const int strips = (static_cast<int>(rows.size()) - 1 + edge - 1) / edge;
    // The memory that all surfaces of the file need is estimated from a few of its rows: at most six groups
    // of 16 rows, spread over the file.
    const int probes = std::clamp(strips / 8, 1, 6);
    std::vector<std::uint8_t> probed(static_cast<std::size_t>(strips), 0);
    double records = 1;
    for (int i = 0; i < probes; ++i) {
        const int strip = (2 * i + 1) * strips / (2 * probes);
        probed[static_cast<std::size_t>(strip)] = 1;
        for (int y = strip * edge; y < std::min((strip + 1) * edge, static_cast<int>(rows.size())); ++y)
            records += rows[static_cast<std::size_t>(y)].records;
    }
    std::atomic<std::size_t> bytes{0};
    SheetChoice choice;
    choice.rows = [&](int y) { return probed[static_cast<std::size_t>((y - file.y_begin()) / edge)] != 0; };
    choice.squares = [&](TreeSheets& some, int, std::size_t) {
        for (const SheetMesh* mesh : {&some.primary, &some.deeper})
            bytes += bytes_of(*mesh) + bytes_of(cut_patches(*mesh, lens));
        some = {};
        some.deeper.values = 5;
    };
    static_cast<void>(tree_sheets(file, 0, rule, {}, choice));
    return static_cast<double>(bytes) / records;
}

void FieldSurfaces::add(std::shared_ptr<const TreeSheets> some, const PatchLens& lens) {
    sheets.push_back(std::move(some));
    primary.push_back(cut_patches(sheets.back()->primary, lens));
    deeper.push_back(cut_patches(sheets.back()->deeper, lens));
}

void FieldSurfaces::show(PatchField& field) const {
    field.instants.clear();
    for (std::size_t i = 0; i < sheets.size(); ++i)
        field.instants.push_back({&primary[i], deeper[i].patches.empty() ? nullptr : &deeper[i]});
}

FieldStrips::FieldStrips(const SampleFileReader& file, std::size_t instants, PatchLens lens,
                         const HighlightRule& rule, const PatchField& views, const glm::dvec2& lens_box_px,
                         const HighlightMotion* motion)
    : file_(file),
      lens_(std::move(lens)),
      rule_(rule),
      motion_(motion),
      sweep_(views),
      lens_box_px_(lens_box_px),
      instants_(instants) {
    constexpr int edge = SheetMesh::square_px;
    for (Instant& i : instants_)
        i.rows.resize(static_cast<std::size_t>((file.y_end() - file.y_begin() + edge - 1) / edge));
}

std::vector<std::pair<int, int>> FieldStrips::strips(const RasterWindow& window, double most_records) const {
    constexpr int tile = SeenTile::edge;
    const auto records = [&](int y_begin, int y_end) {
        std::uint64_t out = 0;
        for (std::size_t i = 0; i < instants_.size(); ++i) {
            const auto rows = file_.scanlines(i);
            for (int y = std::max(y_begin, file_.y_begin()); y < std::min(y_end, file_.y_end()); ++y)
                out += rows[static_cast<std::size_t>(y - file_.y_begin())].records;
        }
        return out;
    };
    std::vector<std::pair<int, int>> out;
    for (int y = window.y_begin, end = y; y < window.y_end; y = end) {
        std::uint64_t held = records(y, y + tile);
        for (end = y + tile; end < window.y_end; end += tile) {
            held += records(end, end + tile);
            if (static_cast<double>(held) > most_records) break;
        }
        end = std::min(end, window.y_end);
        out.emplace_back(y, end);
    }
    return out;
}

std::vector<FieldStrips::Reach> FieldStrips::reach_of(const PatchMesh& mesh, std::size_t instant) const {
    std::vector<Reach> out(mesh.sheets->sheets.size());
    for (const Patch& patch : mesh.patches) {
        const RasterRect r = sweep_.of(mesh, patch, instant);
        // patch_field draws a margin of one pixel around each surface.
        out[patch.sheet].include(std::floor(r.y_min - 1), std::floor(r.y_max + 1) + 1);
    }
    const auto include = [&](const Highlight& light) {
        const auto w = [](float v) { return static_cast<double>(v); };
        const double reach =
            kernel_margin_px +
            kernel_grows * (std::abs(w(light.w.yx)) * lens_box_px_.x +
                            std::abs(lens_.inverse_focus_per_m - w(light.w.yy)) * lens_box_px_.y);
        out[light.sheet].include(std::floor(w(light.y) - reach), std::ceil(w(light.y) + reach));
    };
    const std::vector<BrightSheet> bright = bright_sheets(*mesh.sheets);
    for (const Highlight& light : mesh.sheets->bright) {
        include(light);
        const SheetKey& key = mesh.sheets->sheets[light.sheet].key;
        if (motion_ == nullptr || !motion_->moves(key) || !rule_.takes(light, key, bright[light.sheet]))
            continue;
        for (const HighlightMotion::Moment& m : motion_->moments(light, key, HighlightMotion::most_moments))
            include(m.light);
    }
    return out;
}

void FieldStrips::note(const TreeSheets& some, const std::vector<Reach>& primary,
                       const std::vector<Reach>& deeper, std::size_t part, int y, Row& row) {
    const auto is_far = [y](const Reach& r) {
        return r.first < y - far_px || r.last > y + SheetMesh::square_px + far_px;
    };
    Far far;
    far.sheets.primary = chosen(some.primary, primary, is_far);
    far.sheets.deeper = chosen(some.deeper, deeper, is_far);
    const std::size_t bytes = bytes_of(far.sheets.primary) + bytes_of(far.sheets.deeper);
    std::copy_if(primary.begin(), primary.end(), std::back_inserter(far.primary), is_far);
    std::copy_if(deeper.begin(), deeper.end(), std::back_inserter(far.deeper), is_far);
    const std::scoped_lock lock(mutex_);
    const bool keeps = far_bytes_ + bytes <= most_far_bytes;
    for (const auto* reaches : {&primary, &deeper}) {
        for (const Reach& r : *reaches) {
            if (!keeps || !is_far(r)) row.near.include(r.first, r.last);
        }
    }
    if (!keeps || (far.primary.empty() && far.deeper.empty())) return;
    far_bytes_ += bytes;
    if (row.far.size() <= part) row.far.resize(part + 1);
    row.far[part] = std::move(far);
}

TreeSheets FieldStrips::read_some(std::size_t instant, int y_begin, int y_end, const SurfacesVisit& visit) {
    Instant& known = instants_[instant];
    const auto row_of = [&](int y) -> Row& {
        return known.rows[static_cast<std::size_t>((y - file_.y_begin()) / SheetMesh::square_px)];
    };
    const auto wanted = [&](const Reach& r) {
        return y_begin < y_end && r.last > y_begin && r.first < y_end;
    };
    SheetChoice choice;
    choice.rows = [&](int y) { return !known.known || visit || wanted(row_of(y).near); };
    choice.squares = [&](TreeSheets& some, int y, std::size_t part) {
        const PatchMesh primary = cut_patches(some.primary, lens_), deeper = cut_patches(some.deeper, lens_);
        const std::vector<Reach> direct = reach_of(primary, instant), seen_in = reach_of(deeper, instant);
        if (!known.known) note(some, direct, seen_in, part, y, row_of(y));
        if (visit) {
            const std::scoped_lock lock(mutex_);
            visit(primary, deeper);
        }
        some = {chosen(some.primary, direct, wanted), chosen(some.deeper, seen_in, wanted)};
    };
    choice.known = [&](std::vector<TreeSheets>& parts, int y) {
        for (const Far& far : row_of(y).far) {
            parts.push_back({chosen(far.sheets.primary, far.primary, wanted),
                             chosen(far.sheets.deeper, far.deeper, wanted)});
        }
    };
    TreeSheets out = tree_sheets(file_, instant, rule_, {}, choice);
    known.known = true;
    return out;
}

FieldSurfaces FieldStrips::read(int y_begin, int y_end) {
    give_back_memory();
    FieldSurfaces out;
    for (std::size_t i = 0; i < instants_.size(); ++i)
        out.add(std::make_shared<TreeSheets>(read_some(i, y_begin, y_end, {})), lens_);
    return out;
}

void FieldStrips::visit(std::size_t instant, const SurfacesVisit& visit) {
    const TreeSheets none = read_some(instant, 0, 0, visit);
    static_cast<void>(none);
}

}  // namespace postlens
