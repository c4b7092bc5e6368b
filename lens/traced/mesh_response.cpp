#include "lens/traced/mesh_response.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"

namespace postlens {

using glm::dvec2;

ResponseGrid mesh_response(const PupilMesh& mesh, double pitch_mm) {
    constexpr int split = 4;
    constexpr double widest_px = 4096;
    const auto raster = [pitch_mm](dvec2 film) { return dvec2(-film.x, film.y) / pitch_mm + 0.5; };
    dvec2 low(HUGE_VAL), high(-HUGE_VAL);
    for (std::size_t k = 0; k < mesh.passes.size(); ++k) {
        if (mesh.passes[k] == 0) continue;
        low = glm::min(low, raster(mesh.film_mm[k]));
        high = glm::max(high, raster(mesh.film_mm[k]));
    }
    if (!(high.x >= low.x)) return {};
    if (!(high.x - low.x < widest_px && high.y - low.y < widest_px)) {
        fail(ExitCode::wrong_arguments,
             "--pixel-pitch: the response is too wide (got {:.4g} px; expected at most {})",
             std::max(high.x - low.x, high.y - low.y), widest_px);
    }
    const dvec2 begin = glm::floor(low);
    ResponseGrid out(static_cast<int>(begin.x), static_cast<int>(begin.y),
                     static_cast<int>(high.x - begin.x) + 1, static_cast<int>(high.y - begin.y) + 1);
    const auto nodes = static_cast<std::size_t>(mesh.nodes);
    double sum = 0;
    for (std::size_t j = 0; j + 1 < nodes; ++j) {
        for (std::size_t i = 0; i + 1 < nodes; ++i) {
            const std::size_t k = j * nodes + i;
            const std::size_t corners[4] = {k, k + 1, k + nodes, k + nodes + 1};
            if (!std::all_of(std::begin(corners), std::end(corners),
                             [&mesh](std::size_t c) { return mesh.passes[c] != 0; }))
                continue;
            dvec2 at[4];
            double energy = 0;
            for (int c = 0; c < 4; ++c) {
                at[c] = raster(mesh.film_mm[corners[c]]);
                energy += static_cast<double>(mesh.weight[corners[c]]);
            }
            for (int b = 0; b < split; ++b) {
                for (int a = 0; a < split; ++a) {
                    const double u = (a + 0.5) / split, v = (b + 0.5) / split;
                    const dvec2 p = glm::mix(glm::mix(at[0], at[1], u), glm::mix(at[2], at[3], u), v);
                    out.at(static_cast<int>(std::floor(p.x)) - out.x_begin,
                           static_cast<int>(std::floor(p.y)) - out.y_begin) += energy;
                    sum += energy;
                }
            }
        }
    }
    if (sum > 0) {
        for (double& s : out.share) s /= sum;
    }
    return out;
}

}  // namespace postlens
