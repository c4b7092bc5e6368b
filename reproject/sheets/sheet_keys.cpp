#include "reproject/sheets/sheet_keys.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <unordered_map>

namespace postlens {
namespace {

/// A surface lies closely behind another surface on the same eye ray if their inverse depths differ by less
/// than this fraction. Since each depth is approximated by planes, an error could bring the hidden surface in
/// front. Therefore, such a hidden part has its own key.
constexpr float closely_behind = 0.04F;

struct KeyHash {
    std::size_t operator()(const SheetKey& k) const {
        std::uint64_t h = k.path.bits() * 0x9E3779B97F4A7C15ULL;
        h = (h ^ (h >> 29U) ^ k.parent_id) * 0xBF58476D1CE4E5B9ULL;
        h = (h ^ (h >> 32U) ^ k.id ^ (k.hidden ? std::uint64_t{1} << 40U : 0)) * 0x94D049BB133111EBULL;
        return static_cast<std::size_t>(h ^ (h >> 31U));
    }
};

}  // namespace

void find_sheet_keys(const SampleTrees& trees, SheetKeys& out) {
    out.keys.clear();
    out.of_node.resize(trees.nodes.size());
    std::unordered_map<SheetKey, std::uint32_t, KeyHash> numbers;
    // A cache of recently seen surfaces, indexed by hash, because neighbouring samples usually show the same
    // surfaces.
    struct Recent {
        SheetKey key;
        std::uint32_t number = 0;
        bool known = false;
    };
    std::array<Recent, 256> recent;
    std::size_t sample = 0;
    for (std::size_t i = 0; i < trees.nodes.size(); ++i) {
        while (trees.offsets[sample + 1] <= i) ++sample;
        const TreeSurface& s = trees.nodes[i];
        const bool hidden = s.path.bits() == 0 && i > trees.offsets[sample] &&
                            s.inverse_z >= (1 - closely_behind) * trees.nodes[i - 1].inverse_z;
        const SheetKey key{s.path, s.parent_id, s.id, hidden};
        Recent& r = recent[KeyHash()(key) % recent.size()];
        if (!r.known || !(r.key == key)) {
            const auto [found, is_new] =
                numbers.try_emplace(key, static_cast<std::uint32_t>(out.keys.size()));
            if (is_new) out.keys.push_back(key);
            r = {key, found->second, true};
        }
        out.of_node[i] = r.number;
    }
    if (std::is_sorted(out.keys.begin(), out.keys.end())) return;
    std::vector<std::uint32_t> order(out.keys.size()), rank(order.size());
    std::iota(order.begin(), order.end(), 0U);
    std::sort(order.begin(), order.end(),
              [&](std::uint32_t a, std::uint32_t b) { return out.keys[a] < out.keys[b]; });
    std::vector<SheetKey> sorted;
    sorted.reserve(order.size());
    for (std::uint32_t i = 0; i < order.size(); ++i) {
        rank[order[i]] = i;
        sorted.push_back(out.keys[order[i]]);
    }
    out.keys = std::move(sorted);
    for (std::uint32_t& n : out.of_node) n = rank[n];
}

}  // namespace postlens
