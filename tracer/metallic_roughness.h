// The metallic-roughness model of glTF in the coefficients of Whitted's.
#pragma once

#include <glm/glm.hpp>

#include "tracer/scene.h"

namespace postlens {

/// A surface as glTF describes it [gltf2, appendix B; KHR_materials_*], textures aside.
struct MetallicRoughness {
    glm::dvec3 base{1};       ///< base colour, scene-linear, 0 to 1
    double alpha = 1;         ///< share of the surface that is there, 0 to 1
    double metallic = 1;      ///< 0 to 1
    double roughness = 1;     ///< 0 to 1; the width of its microfacets is its square
    double transmission = 0;  ///< 0 to 1, of what is not metallic
    double ior = 1.5;         ///< >= 1
    bool solid = false;       ///< false: transmits as a thin sheet does, straight on
    double specular = 1;      ///< KHR_materials_specular, 0 to 1
    glm::dvec3 specular_colour{1};
    glm::dvec3 emission{0};
    bool unlit = false;  ///< shows its base colour, whatever the light
};

/// What becomes of it, with a = roughness^2, q = (1 - roughness)^2 and F0 = ((ior - 1) / (ior + 1))^2
/// specular specular_colour of what is not metallic, `base` of what is, mixed by `metallic`:
///   fresnel              true; F90 = specular of what is not metallic, 1 of what is
///   diffuse              base ((1 - metallic) (1 - transmission) + metallic a)
///   diffuse_transmission base (1 - metallic) transmission a
///   reflection           F0 q, at grazing angles F90 q
///   specular             (1 - a) min(F0 / (4 a^2), 1), at grazing angles with F90
///   shininess            (1 / a^2 - 1) / 2, 1 to 1e6
///   transmission         base (1 - metallic) transmission (1 - a) (1 - F0), 0 at grazing angles
///   ambient              0.1 diffuse
/// The highlight is that of GGX microfacets at its centre, D = 1 / (pi a^2), and as wide: Blinn's exponent 2
/// / a^2 - 2, a quarter of it about the mirrored direction. What a rough metal mirrors of everything around
/// it stands in `diffuse`. The lobes of mirrored and refracted rays have the highlight's exponent where the
/// roughness is above 0.02. Everything but
/// emission is times `alpha`; the rest passes straight on, which takes an ior of 1.
[[nodiscard]] Material whitted_material(const MetallicRoughness& from);

}  // namespace postlens
