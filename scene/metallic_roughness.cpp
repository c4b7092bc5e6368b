#include "scene/metallic_roughness.h"

#include <algorithm>
#include <cmath>

namespace postlens {

using glm::dvec3;

Material whitted_material(const MetallicRoughness& from) {
    Material m;
    m.emission = from.alpha * from.emission;
    const double through = 1 - from.alpha;
    if (from.unlit) {
        m.ambient = m.diffuse = dvec3(0);
        m.emission = from.alpha * from.base;
        m.transmission = dvec3(through);
        return m;
    }
    // Below this roughness, lobes are narrower than a pixel, so the material counts as perfectly specular.
    constexpr double smoothest = 0.02, largest_exponent = 1e6;
    const double a = from.roughness * from.roughness, q = (1 - from.roughness) * (1 - from.roughness);
    const double ratio = (from.ior - 1) / (from.ior + 1);
    const dvec3 dielectric = glm::min(ratio * ratio * from.specular_colour, dvec3(1)) * from.specular;
    const dvec3 f0 = glm::mix(dielectric, from.base, from.metallic);
    const dvec3 body = from.alpha * (1 - from.metallic) * from.base;

    m.diffuse = body * (1 - from.transmission) + from.alpha * from.metallic * a * from.base;
    m.diffuse_transmission = body * from.transmission * a;
    m.ambient = 0.1 * m.diffuse;
    const dvec3 f90 = dvec3(std::lerp(from.specular, 1.0, from.metallic));
    const auto highlight = [&](const dvec3& fresnel) {
        return from.alpha * (1 - a) * glm::min(fresnel / std::max(4 * a * a, 1e-12), dvec3(1));
    };
    m.fresnel = true;
    m.reflection = from.alpha * q * f0;
    m.reflection_grazing = from.alpha * q * f90;
    m.specular = highlight(f0);
    m.specular_grazing = highlight(f90);
    m.transmission_grazing = dvec3(through);
    m.shininess = std::clamp((1 / std::max(a * a, 1e-12) - 1) / 2, 1.0, largest_exponent);
    m.transmission = body * from.transmission * (1 - a) * (dvec3(1) - f0) + dvec3(through);
    m.ior = from.solid && from.alpha == 1 ? from.ior : 1;
    if (from.roughness > smoothest) {
        if (m.reflects()) m.reflection_exponent = m.shininess;
        // `transmission_exponent` blurs the transmitted light of a rough surface. If alpha is below 1, the
        // part `through` of the light is transmitted without scattering and must stay sharp. But a Material
        // has one exponent for all transmitted light, so it is set only if `through` is 0.
        if (through == 0 && m.transmission != dvec3(0)) m.transmission_exponent = m.shininess;
    }
    return m;
}

}  // namespace postlens
