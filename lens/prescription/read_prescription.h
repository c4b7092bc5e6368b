// Reads lens prescriptions from files.
#pragma once

#include <filesystem>

#include "lens/prescription/prescription.h"

namespace postlens {

/// Reads a prescription from a file in UTF-8 or UTF-16. The file name extension selects the format: .dat
/// (pbrt), .zmx (Zemax), .seq (CODE V) or .toml (our own format). docs/lens_prescriptions.md describes the
/// formats. The returned prescription has passed `check_prescription` and is not afocal. Throws
/// Error(invalid_input) "FILE:LINE: what (got X; expected Y)".
[[nodiscard]] Prescription read_prescription(const std::filesystem::path& path);

/// Returns true if `read_prescription` reads files with this extension. A .toml file must also contain
/// [[surface]] tables. Returns false if the file cannot be read.
[[nodiscard]] bool is_prescription(const std::filesystem::path& path);

}  // namespace postlens
