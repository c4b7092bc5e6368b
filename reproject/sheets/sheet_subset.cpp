#include "reproject/sheets/sheet_subset.h"

namespace postlens {
namespace {

class Subset {
  public:
    explicit Subset(const SheetMesh& from)
        : from_(from),
          node_(from.nodes.size(), SheetNode::none),
          texel_(from.texels.size(), SheetNode::none) {
        to_.time_s = from.time_s;
        to_.values = from.values;
    }

    void add(std::uint32_t sheet) {
        Sheet s = from_.sheets[sheet];
        const std::size_t first = s.first_cell,
                          cells = static_cast<std::size_t>(s.width) * static_cast<std::size_t>(s.height);
        number_ = static_cast<std::uint32_t>(to_.sheets.size());
        s.first_cell = static_cast<std::uint32_t>(to_.fine.size());
        to_.sheets.push_back(s);
        for (std::size_t i = first; i < first + cells; ++i) {
            to_.fine.push_back(tree(from_.fine[i]));
            to_.coarse.push_back(tree(from_.coarse[i]));
            if (from_.has_w()) to_.bends.push_back(from_.bends[i]);
        }
        const auto planes = from_.planes.begin();
        to_.planes.insert(to_.planes.end(), planes + static_cast<std::ptrdiff_t>(first * from_.values),
                          planes + static_cast<std::ptrdiff_t>((first + cells) * from_.values));
    }

    /// Completes the copy of the mesh and returns it. Each highlight (bright radiance of a surface) stores
    /// the index of its sheet, which differs in the copy. `number` gives the new index for each sheet of the
    /// original, or SheetNode::none if the sheet is not copied.
    SheetMesh finish(std::span<const std::uint32_t> number) {
        std::vector<std::uint32_t> light(from_.bright.size() + 1);
        for (std::size_t i = 0; i < from_.bright.size(); ++i) {
            light[i] = static_cast<std::uint32_t>(to_.bright.size());
            Highlight h = from_.bright[i];
            h.sheet = number[h.sheet];
            if (h.sheet != SheetNode::none) to_.bright.push_back(h);
        }
        for (BrightTexel b : from_.bright_texels) {
            b.texel = texel_[b.texel];
            b.first_light = light[b.first_light];
            if (b.texel != SheetNode::none) to_.bright_texels.push_back(b);
        }
        return std::move(to_);
    }

  private:
    std::uint32_t tree(std::uint32_t node) {
        if (SheetNode::empty(node)) return node;
        if ((node & SheetNode::leaf) != 0) return SheetNode::leaf | texel(node & ~SheetNode::leaf);
        if (node_[node] != SheetNode::none) return node_[node];
        const auto first = static_cast<std::uint32_t>(to_.nodes.size());
        node_[node] = first;
        to_.nodes.resize(to_.nodes.size() + 4);
        for (std::uint32_t k = 0; k < 4; ++k) {
            const std::uint32_t child = tree(from_.nodes[node + k]);
            to_.nodes[first + k] = child;
        }
        return first;
    }
    std::uint32_t texel(std::uint32_t old) {
        if (texel_[old] != SheetNode::none) return texel_[old];
        texel_[old] = static_cast<std::uint32_t>(to_.texels.size());
        Texel t = from_.texels[old];
        t.info = Texel::info_of(number_, t.children(), t.unsure_bits());
        to_.texels.push_back(t);
        if (!from_.below.empty()) to_.below.push_back(from_.below[old]);
        return texel_[old];
    }

    const SheetMesh& from_;
    SheetMesh to_;
    std::uint32_t number_ = 0;
    std::vector<std::uint32_t> node_, texel_;  ///< new number for each old one; `none` if not copied
};

}  // namespace

SheetMesh sheet_subset(const SheetMesh& mesh, std::span<const std::uint8_t> wanted) {
    Subset subset(mesh);
    std::vector<std::uint32_t> number(mesh.sheets.size(), SheetNode::none);
    std::uint32_t count = 0;
    for (std::uint32_t i = 0; i < mesh.sheets.size(); ++i) {
        if (wanted[i] == 0) continue;
        number[i] = count++;
        subset.add(i);
    }
    return subset.finish(number);
}

}  // namespace postlens
