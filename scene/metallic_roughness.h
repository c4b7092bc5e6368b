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
    double roughness = 1;     ///< 0 to 1; its square is the width parameter of the microfacets
    double transmission = 0;  ///< fraction that the non-metallic part transmits, 0 to 1
    double ior = 1.5;         ///< >= 1
    bool solid = false;       ///< false: a thin surface, which transmits without refraction
    double specular = 1;      ///< KHR_materials_specular, 0 to 1
    glm::dvec3 specular_colour{1};
    glm::dvec3 emission{0};
    bool unlit = false;  ///< emits its base colour, whatever the lights
};

/// Returns Whitted's material for a glTF material.
/// F0 and F90 are the reflectances at normal and at grazing incidence.
/// mix(x, y) interpolates by `metallic` between x (non-metallic) and y (metallic).
///   a                    roughness^2
///   q                    (1 - roughness)^2
///   F0                   mix(((ior - 1) / (ior + 1))^2 specular specular_colour, base)
///   F90                  mix(specular, 1)
/// The coefficients of the result are:
///   fresnel              true
///   diffuse              base ((1 - metallic) (1 - transmission) + metallic a)
///   diffuse_transmission base (1 - metallic) transmission a
///   reflection           F0 q, at grazing angles F90 q
///   specular             (1 - a) min(F0 / (4 a^2), 1), at grazing angles with F90
///   shininess            (1 / a^2 - 1) / 2, 1 to 1e6
///   transmission         base (1 - metallic) transmission (1 - a) (1 - F0), 0 at grazing angles
///   ambient              0.1 diffuse
///
/// The highlight is as wide as that of GGX microfacets and has the same central value, 1 / (pi a^2).
/// For this width, Blinn's exponent is 2 / a^2 - 2. `shininess` is a quarter of it,
/// because it applies to the angle from the mirrored direction.
/// Above a roughness of 0.02, the lobes of reflected and refracted rays have the exponent `shininess`, too.
/// `diffuse` includes the light that a rough metal reflects from all directions.
///
/// glTF blends a surface over what is behind it, so all coefficients and the emission are multiplied by
/// `alpha`. If `alpha` is below 1, the remaining light passes without refraction, so the ior is 1.
[[nodiscard]] Material whitted_material(const MetallicRoughness& from);

}  // namespace postlens
