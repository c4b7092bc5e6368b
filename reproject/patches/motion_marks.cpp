#include "reproject/patches/motion_marks.h"

#include <algorithm>

namespace postlens {

MotionMarks::MotionMarks(const PatchField& field) : field_(field) {
    for (std::size_t i = 0; i < field.instants.size(); ++i) {
        marks_.emplace_back();
        if (any()) {
            for (const Sheet& s : field.instants[i].primary->sheets->sheets)
                marks_[i].push_back(field.class_marks[field.motion_class(s.key.id)]);
        }
    }
}

bool MotionMarks::any_wanted(std::size_t instant, std::span<const std::uint32_t> patches) const {
    return std::any_of(patches.begin(), patches.end(), [&](std::uint32_t p) {
        return (marks_[instant][field_.instants[instant].primary->patches[p].sheet] & field_.wanted_marks) !=
               0;
    });
}

void MotionMarks::mark_recorded(std::size_t instant, const PatchMesh& mesh, const TilePlace& at,
                                Touched& touched) const {
    for (const Patch& p : mesh.patches) {
        const std::uint8_t mark = marks_[instant][p.sheet];
        if (mark == 0) continue;
        const Sheet& s = mesh.sheet(p);
        for (int y = p.y; y < p.y + p.height; ++y) {
            for (int x = p.x; x < p.x + p.width; ++x) {
                const int px = s.x + x - at.x, py = s.y + y - at.y;
                if (px < 0 || py < 0 || px >= at.width || py >= at.height) continue;
                const int cell = y * s.width + x, pixel = py * SeenTile::edge + px;
                if (mesh.sheets->fine[s.first_cell + static_cast<std::size_t>(cell)] != SheetNode::none)
                    touched[static_cast<std::size_t>(pixel)] |= mark;
            }
        }
    }
}

void MotionMarks::mark_seen(const PatchView& v, const TilePlace& at, const SeenTile* seen,
                            Touched& touched) const {
    for (int y = 0; y < at.height; ++y) {
        for (int x = 0; x < at.width; ++x) {
            const auto k = static_cast<std::size_t>(y) * SeenTile::edge + static_cast<std::size_t>(x);
            bool any = false;
            for (std::size_t u = 0; u < v.uses.size(); ++u) {
                const std::uint32_t texel = seen[u].texel[k];
                if (texel == SeenTile::no_texel) continue;
                any = true;
                const std::size_t i = v.uses[u].instant;
                touched[k] |= marks_[i][field_.instants[i].primary->sheets->texels[texel].sheet()];
            }
            if (!any) touched[k] = 0xFF;
        }
    }
}

}  // namespace postlens
