#include "scene/object_parts.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>
#include <tuple>

#include "core/threads.h"

namespace postlens {
namespace {

/// Returns, for each position, the lowest index of an equal position.
std::vector<std::uint32_t> same_positions(const std::vector<glm::vec3>& positions) {
    std::vector<std::uint32_t> order(positions.size());
    std::iota(order.begin(), order.end(), 0U);
    const auto place = [&](std::uint32_t i) {
        return std::tie(positions[i].x, positions[i].y, positions[i].z);
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return place(a) != place(b) ? place(a) < place(b) : a < b;
    });
    std::vector<std::uint32_t> first(positions.size());
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool is_same = i > 0 && place(order[i]) == place(order[i - 1]);
        first[order[i]] = is_same ? first[order[i - 1]] : order[i];
    }
    return first;
}

}  // namespace

std::vector<MeshEdge> edges_of(const Mesh& mesh) {
    // A side of a triangle. Sides are grouped by their lower vertex index, so only the higher is stored.
    struct Side {
        std::uint32_t high_end = 0, triangle = 0;
    };
    const std::vector<std::uint32_t> position = same_positions(mesh.positions);
    const auto each_side = [&](const auto& take) {
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
            for (int k = 0; k < 3; ++k) {
                const std::uint32_t a = position[mesh.triangles[t][k]],
                                    b = position[mesh.triangles[t][(k + 1) % 3]];
                take(std::min(a, b), Side{std::max(a, b), t});
            }
        }
    };
    std::vector<std::size_t> end(mesh.positions.size() + 1, 0);
    each_side([&](std::uint32_t low, const Side&) { ++end[low + 1]; });
    std::partial_sum(end.begin(), end.end(), end.begin());
    std::vector<Side> sides(3 * mesh.triangles.size());
    each_side([&](std::uint32_t low, const Side& side) { sides[end[low]++] = side; });
    std::vector<MeshEdge> out;
    out.reserve(sides.size() / 2);
    for (std::uint32_t low = 0; low < mesh.positions.size(); ++low) {
        const auto begin = sides.begin() + static_cast<std::ptrdiff_t>(low > 0 ? end[low - 1] : 0),
                   last = sides.begin() + static_cast<std::ptrdiff_t>(end[low]);
        std::sort(begin, last, [](const Side& a, const Side& b) {
            return a.high_end != b.high_end ? a.high_end < b.high_end : a.triangle < b.triangle;
        });
        for (auto s = begin; s != last; ++s) {
            const bool has_next = s + 1 != last && (s + 1)->high_end == s->high_end;
            const bool has_previous = s != begin && (s - 1)->high_end == s->high_end;
            if (has_next)
                out.push_back({low, s->high_end, s->triangle, (s + 1)->triangle});
            else if (!has_previous)
                out.push_back({low, s->high_end, s->triangle, MeshEdge::none});
        }
    }
    return out;
}

std::vector<std::uint32_t> parts_of(const Mesh& mesh, const std::vector<MeshEdge>& edges) {
    // Union-find: connected triangles form a tree. Its root is the triangle with the lowest index.
    std::vector<std::uint32_t> parent(mesh.triangles.size());
    std::iota(parent.begin(), parent.end(), 0U);
    const auto root = [&](std::uint32_t t) {
        while (parent[t] != t) t = parent[t] = parent[parent[t]];
        return t;
    };
    for (const MeshEdge& edge : edges) {
        if (edge.other == MeshEdge::none) continue;
        const std::uint32_t a = root(edge.triangle), b = root(edge.other);
        parent[std::max(a, b)] = std::min(a, b);
    }
    std::vector<std::uint32_t> parts(mesh.triangles.size());
    std::uint32_t count = 0;
    for (std::uint32_t t = 0; t < parts.size(); ++t) parts[t] = root(t) == t ? count++ : parts[root(t)];
    return count > 1 ? parts : std::vector<std::uint32_t>();
}

ObjectParts::ObjectParts(const Scene& scene) : mesh_(scene.objects.size(), 0) {
    std::map<const Mesh*, std::size_t> index;
    std::vector<const Mesh*> meshes;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const auto* mesh = std::get_if<std::shared_ptr<const Mesh>>(&scene.objects[i].shape);
        if (mesh == nullptr) continue;
        const auto [at, is_new] = index.try_emplace(mesh->get(), meshes.size() + 1);
        if (is_new) meshes.push_back(mesh->get());
        mesh_[i] = at->second;
    }
    meshes_.resize(meshes.size() + 1);
    parallel_for(meshes.size(), [&](std::size_t i) {
        OfMesh& of = meshes_[i + 1];
        of.edges = edges_of(*meshes[i]);
        of.parts = parts_of(*meshes[i], of.edges);
    });
    std::set<std::uint32_t> ids;
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
        const std::vector<std::uint32_t>& parts = of_mesh(i);
        first_.push_back(next);
        next += parts.empty() ? 1 : *std::max_element(parts.begin(), parts.end()) + 1;
        any_ = any_ || !parts.empty() || !ids.insert(scene.objects[i].id).second;
    }
}

}  // namespace postlens
