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

/// Returns true if the file is a lens prescription: its extension is .dat, .zmx or .seq, or it is a readable
/// .toml file with [[surface]] tables.
[[nodiscard]] bool is_prescription(const std::filesystem::path& path);

}  // namespace postlens
