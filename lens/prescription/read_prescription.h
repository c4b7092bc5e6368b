// Reads lens prescriptions from files.
#pragma once

#include <filesystem>

#include "lens/prescription/prescription.h"

namespace postlens {

/// Reads a prescription (docs/lens_prescriptions.md). The extension selects the format: .dat (pbrt), .zmx
/// (Zemax), .seq (CODE V) or .toml (ours).
///
/// The prescription has passed `check_prescription` and is not afocal. Throws Error(invalid_input)
/// "FILE:LINE: what (got X; expected Y)".
[[nodiscard]] Prescription read_prescription(const std::filesystem::path& path);

/// Returns true for a lens prescription: a .dat, .zmx or .seq file, or a readable .toml file with [[surface]]
/// tables.
[[nodiscard]] bool is_prescription(const std::filesystem::path& path);

}  // namespace postlens
