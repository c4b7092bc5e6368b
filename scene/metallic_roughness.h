// Converts the metallic-roughness model of glTF to the coefficients of Whitted's model.
#pragma once

#include <glm/glm.hpp>

#include "scene/scene.h"

namespace postlens {

/// A material of glTF [gltf2, appendix B; KHR_materials_*], without textures.
struct MetallicRoughness {
    glm::dvec3 base{1};       ///< base colour, scene-linear, 0 to 1
    double alpha = 1;         ///< opacity, 0 to 1
    double metallic = 1;      ///< 0 to 1
    double roughness = 1;     ///< 0 to 1; the square of it is the width parameter of the microfacets
    double transmission = 0;  ///< fraction transmitted by the part that is not metallic, 0 to 1
    double ior = 1.5;         ///< >= 1
    bool solid = false;       ///< false: a thin surface, which transmits without refraction
    double specular = 1;      ///< KHR_materials_specular, 0 to 1
    glm::dvec3 specular_colour{1};
    glm::dvec3 emission{0};
    bool unlit = false;  ///< emits its base colour, whatever the lights
};

/// Whitted's material with a = roughness^2 and q = (1 - roughness)^2. F0, the reflectance at normal
/// incidence, is a mix by `metallic` of ((ior - 1) / (ior + 1))^2 specular specular_colour (not metallic) and
/// `base` (metallic). F90 is that at grazing incidence:
///   fresnel              true; F90 = mix by `metallic` of `specular` (not metallic) and 1 (metallic)
///   diffuse              base ((1 - metallic) (1 - transmission) + metallic a)
///   diffuse_transmission base (1 - metallic) transmission a
///   reflection           F0 q, at grazing angles F90 q
///   specular             (1 - a) min(F0 / (4 a^2), 1), at grazing angles with F90
///   shininess            (1 / a^2 - 1) / 2, 1 to 1e6
///   transmission         base (1 - metallic) transmission (1 - a) (1 - F0), 0 at grazing angles
///   ambient              0.1 diffuse
/// The highlight has the centre value D = 1 / (pi a^2) and the width of GGX microfacets. Blinn's exponent for
/// this width is 2 / a^2 - 2, and the exponent about the mirrored direction is a quarter of that. `diffuse`
/// includes the light that a rough metal reflects from all directions. If the roughness is above 0.02, the
/// lobes of reflected and refracted rays have the exponent of the highlight. All coefficients are multiplied
/// by `alpha`, the emission too, because glTF draws the surface's whole colour over what is behind it. If
/// `alpha` is below 1, the remaining light passes without refraction, so the ior is 1.
[[nodiscard]] Material whitted_material(const MetallicRoughness& from);

}  // namespace postlens
