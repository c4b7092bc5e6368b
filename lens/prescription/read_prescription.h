// Reads lens prescriptions from files.
#pragma once

#include <filesystem>

#include "lens/prescription/prescription.h"

namespace postlens {

/// Reads a lens prescription from a .dat (pbrt), .zmx (Zemax), .seq (CODE V) or .toml (our own format) file,
/// as its extension says (docs/lens_prescriptions.md). The returned prescription has passed
/// `check_prescription` and is not afocal.
///
/// Throws Error(invalid_input) with a message of the form "FILE:LINE: what (got X; expected Y)".
[[nodiscard]] Prescription read_prescription(const std::filesystem::path& path);

/// Returns true for a lens prescription: a .dat, .zmx or .seq file, or a readable .toml file with [[surface]]
/// tables.
[[nodiscard]] bool is_prescription(const std::filesystem::path& path);

}  // namespace postlens
