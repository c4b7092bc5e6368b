// Reads lens prescriptions from files.
#pragma once

#include <filesystem>

#include "lens/prescription/prescription.h"

namespace postlens {

/// Reads a prescription. The file name extension selects the format: .dat (pbrt), .zmx (Zemax), .seq
/// (CODE V), .toml (own format); docs/lens_prescriptions.md describes them. Text is UTF-8 or UTF-16 with a
/// byte order mark. The result has passed `check_prescription` and has a power other than 0. Throws
/// Error(invalid_input) "FILE:LINE: what (got X; expected Y)".
[[nodiscard]] Prescription read_prescription(const std::filesystem::path& path);

/// True if `read_prescription` reads this kind of file, by its extension; a .toml file must contain
/// [[surface]] tables. False if the file cannot be read.
[[nodiscard]] bool is_prescription(const std::filesystem::path& path);

}  // namespace postlens
