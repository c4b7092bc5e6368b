// Reads lens prescriptions from files.
#pragma once

#include <filesystem>

#include "lens/prescription/prescription.h"

namespace postlens {

/// Reads a prescription. The file name extension selects the format: .dat (pbrt), .zmx (Zemax), .seq (CODE V)
/// or .toml (own format); docs/lens_prescriptions.md describes them. The text is UTF-8, or UTF-16 with a byte
/// order mark. The result has passed `check_prescription` and has a power other than 0. Throws
/// Error(invalid_input) "FILE:LINE: what (got X; expected Y)".
[[nodiscard]] Prescription read_prescription(const std::filesystem::path& path);

/// True if the file's extension is one that `read_prescription` reads; a .toml file must also contain
/// [[surface]] tables. False if the file cannot be read.
[[nodiscard]] bool is_prescription(const std::filesystem::path& path);

}  // namespace postlens
