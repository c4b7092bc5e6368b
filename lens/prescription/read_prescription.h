// Prescriptions from files.
#pragma once

#include <filesystem>

#include "lens/prescription/prescription.h"

namespace postlens {

/// By the ending: .dat (pbrt), .zmx (Zemax), .seq (CODE V), .toml (ours); docs/lens_prescriptions.md
/// describes them. Text is UTF-8, or UTF-16 with its byte order mark. The result has passed
/// `check_prescription` and has a power. Throws Error(invalid_input) "FILE:LINE: what (got X; expected Y)".
[[nodiscard]] Prescription read_prescription(const std::filesystem::path& path);

/// Whether `read_prescription` is the reader of a file, by its ending; a .toml by its [[surface]] tables.
/// False where it cannot be read.
[[nodiscard]] bool is_prescription(const std::filesystem::path& path);

}  // namespace postlens
