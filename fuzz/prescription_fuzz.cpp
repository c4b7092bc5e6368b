// Fuzzes the readers of all formats of lens prescriptions. The first byte chooses the format.
#include <cmath>
#include <cstdlib>

#include "core/error.h"
#include "fuzz/fuzz_file.h"
#include "lens/prescription/first_order.h"
#include "lens/prescription/read_prescription.h"
#include "lens/traced/lens_stack.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    if (size == 0) return 0;
    static constexpr const char* endings[] = {".dat", ".zmx", ".seq", ".toml"};
    try {
        const auto lens =
            postlens::read_prescription(postlens::fuzz_file(data + 1, size - 1, endings[data[0] % 4]));
        // An accepted lens must have a finite focal length, and rays through it must end at
        // one of its surfaces.
        const postlens::FirstOrder f = postlens::first_order(lens);
        if (!std::isfinite(f.efl_mm) || lens.surfaces.size() > postlens::most_surfaces) std::abort();
        const postlens::LensStack stack(lens, lens.wavelength_nm, f.stop_radius_mm);
        for (const double y : {0.0, 0.1, 1.0, 10.0}) {
            postlens::LensRay ray{{0.2 * y, y, 0}, {0, 0, 1}};
            const postlens::RayEnd end = stack.forward(ray);
            if (end.surface >= lens.surfaces.size()) std::abort();
            if (end.passes() && !(std::abs(glm::length(ray.direction) - 1) < 1e-6)) std::abort();
        }
    } catch (const postlens::Error&) {
        // The reader may refuse the input.
    }
    return 0;
}
