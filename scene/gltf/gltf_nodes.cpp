#include "scene/gltf/gltf_nodes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "records/motion/scene_limits.h"

namespace postlens {
namespace {

using glm::dmat4;
using glm::dvec3;

constexpr int most_frames = 256;
constexpr double largest_scale = 1e9;

dvec3 vector(const std::vector<double>& v) {
    return {v[0], v[1], v[2]};
}

struct Local {
    dmat4 matrix{1};
    Placement placement;
    double shear = 0;
};

Local local_of(const JsonPlace& node, double unit) {
    Local out;
    if (const auto m = node.numbers("matrix", 16, -largest_length_m, largest_length_m)) {
        for (std::size_t i = 0; i < 16; ++i) {
            out.matrix[static_cast<int>(i / 4)][static_cast<int>(i % 4)] = (*m)[i];
        }
        if (out.matrix[0].w != 0 || out.matrix[1].w != 0 || out.matrix[2].w != 0 || out.matrix[3].w != 1) {
            node.fail_here("has a 'matrix' that is not affine (expected a last row of 0, 0, 0, 1)");
        }
        out.matrix[3] = glm::dvec4(unit * dvec3(out.matrix[3]), 1);
        const Decomposed d = decompose(out.matrix);
        out.placement = d.placement;
        out.shear = d.error;
        return out;
    }
    if (const auto t = node.numbers("translation", 3, -largest_length_m, largest_length_m)) {
        out.placement.translation = unit * vector(*t);
    }
    if (const auto r = node.numbers("rotation", 4, -1e6, 1e6)) {
        const glm::dquat q((*r)[3], (*r)[0], (*r)[1], (*r)[2]);
        if (!(glm::length(q) > 1e-9)) node.fail_here("has a 'rotation' of no length");
        out.placement.rotation = glm::normalize(q);
    }
    if (const auto s = node.numbers("scale", 3, -largest_scale, largest_scale))
        out.placement.scale = vector(*s);
    out.matrix = matrix_of(out.placement);
    return out;
}

// Returns the parent of each node, or empty for a root. Throws an error if a node has two parents.
std::vector<std::optional<std::size_t>> parents_of(const GltfDocument& d) {
    std::vector<std::optional<std::size_t>> parents(d.count("nodes"));
    const auto nodes = d.root().objects("nodes");
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        for (const std::size_t child : nodes[i].indices("children", nodes.size())) {
            if (parents[child]) {
                nodes[i].fail_here("is above nodes[{}] as nodes[{}] is (expected one node above each)", child,
                                   *parents[child]);
            }
            parents[child] = i;
        }
    }
    return parents;
}

}  // namespace

GltfNodes::GltfNodes(const GltfDocument& document, std::map<std::size_t, GltfNodeCurves> curves, double unit,
                     SceneNotes& notes)
    : d_(document), curves_(std::move(curves)), notes_(notes) {
    const std::size_t scenes = d_.count("scenes");
    if (scenes == 0) fail(ExitCode::invalid_input, "{}: has no scene (expected at least one)", d_.file);
    const std::size_t shown = d_.root().index("scene", scenes).value_or(0);
    if (scenes > 1) notes_.add(fmt::format("of {} scenes number {} is shown", scenes, shown));
    const auto parents = parents_of(d_);
    const JsonPlace scene = d_.item("scenes", shown);
    // The search visits the descendants of the scene's roots. It runs into no cycle, because each node has at
    // most one parent, and roots have none.
    std::vector<std::pair<std::size_t, std::optional<std::size_t>>>
        open;  // node, index of its parent in nodes_
    std::vector<bool> seen(parents.size(), false);
    for (const std::size_t root : scene.indices("nodes", parents.size())) {
        if (parents[root]) {
            scene.fail_here("has nodes[{}] as a root, which stands below nodes[{}]", root, *parents[root]);
        }
        if (seen[root]) scene.fail_here("has nodes[{}] twice", root);
        seen[root] = true;
        open.emplace_back(root, std::nullopt);
    }
    std::reverse(open.begin(), open.end());
    while (!open.empty()) {
        const auto [index, parent] = open.back();
        open.pop_back();
        const std::size_t place = nodes_.size();
        const std::optional<GltfNode> above = parent ? std::optional(nodes_[*parent]) : std::nullopt;
        add(index, above ? &*above : nullptr, unit);
        auto children = d_.item("nodes", index).indices("children", parents.size());
        std::reverse(children.begin(), children.end());
        for (const std::size_t child : children) open.emplace_back(child, place);
    }
}

void GltfNodes::add(std::size_t index, const GltfNode* parent, double unit) {
    const JsonPlace place = d_.item("nodes", index);
    const Local local = local_of(place, unit);
    GltfNode node;
    node.index = index;
    node.world_from_node = (parent ? parent->world_from_node : dmat4(1)) * local.matrix;
    for (int column = 0; column < 4; ++column) {
        for (int row = 0; row < 3; ++row) {
            if (!(std::abs(node.world_from_node[column][row]) <= largest_length_m)) {
                place.fail_here("stands out of range (expected at most {} m from the origin)",
                                largest_length_m);
            }
        }
    }
    const dmat4 above_from_parent = parent && parent->frame ? parent->frame_from_node
                                    : parent                ? parent->world_from_node
                                                            : dmat4(1);
    if (parent) node.frame = parent->frame;
    node.frame_from_node = node.frame ? above_from_parent * local.matrix : dmat4(1);
    if (curves_.contains(index)) {
        Frame frame;
        frame.above = node.frame;
        const Decomposed between = decompose(above_from_parent);
        frame.above_from_parent = between.placement;
        frame.shear = std::max(between.error, local.shear);
        frame.own = local.placement;
        frame.depth = frame.above ? frames_.at(*frame.above).depth + 1 : 1;
        if (frame.depth > most_frames) {
            place.fail_here("has too many nodes above it that move (expected at most {})", most_frames);
        }
        frames_.emplace(index, frame);
        node.frame = index;
        node.frame_from_node = dmat4(1);
    }
    nodes_.push_back(node);
}

Decomposed GltfNodes::placed(std::size_t index, double time_s) const {
    const Frame& frame = frames_.at(index);
    Decomposed out = compose(frame.above_from_parent, curves_.at(index).at(time_s, frame.own));
    out.error = std::max(out.error, frame.shear);
    for (auto above = frame.above; above;) {
        const Frame& f = frames_.at(*above);
        const Decomposed outer = compose(f.above_from_parent, curves_.at(*above).at(time_s, f.own));
        const Decomposed both = compose(outer.placement, out.placement);
        out = {both.placement, std::max({out.error, outer.error, both.error, f.shear})};
        above = f.above;
    }
    return out;
}

Placement GltfNodes::frame_at(std::size_t frame, double time_s) const {
    return placed(frame, time_s).placement;
}

std::vector<double> GltfNodes::frame_times_s(std::size_t frame) const {
    std::vector<double> out;
    for (std::optional<std::size_t> at = frame; at; at = frames_.at(*at).above) {
        const auto times = curves_.at(*at).times_s();
        out.insert(out.end(), times.begin(), times.end());
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
}

double GltfNodes::frame_shear(std::size_t frame) const {
    double worst = 0;
    for (const double t : frame_times_s(frame)) worst = std::max(worst, placed(frame, t).error);
    return worst;
}

}  // namespace postlens
