// Prescriptions from the files of tests/data/lens, and from text.
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "lens/prescription/prescription.h"
#include "lens/prescription/read_prescription.h"
#include "tests/support/temporary_folder.h"

namespace postlens::test {

/// Reads a prescription from a file of tests/data/lens.
inline Prescription published_lens(const std::string& name) {
    return read_prescription(std::filesystem::path(POSTLENS_TEST_DATA) / "lens" / name);
}

/// Reads a prescription from its text. The extension of `name` states the format.
inline Prescription lens_of_text(const std::string& text, const std::string& name) {
    const TemporaryFolder folder;
    const auto path = folder.path() / name;
    std::ofstream(path) << text;
    return read_prescription(path);
}

}  // namespace postlens::test
