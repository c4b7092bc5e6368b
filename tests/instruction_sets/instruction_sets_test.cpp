// All clones of all kernels give bit-identical results, for any variants that the C library and Embree
// select. scripts/check_instruction_sets.sh tests this for emulated processors, including libraries.
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <iostream>
#include <map>
#include <string>

#include "tests/support/command_test.h"

namespace postlens::test::instruction_sets_test {
namespace {

namespace fs = std::filesystem;

class InstructionSets : public testing::Test {
  protected:
    // Names and bytes of all files that tests/instruction_sets/results.sh writes.
    std::map<std::string, std::string> results(const std::string& program, const std::string& settings = "") {
        const fs::path out = folder_.path() / "results", err = folder_.path() / "errors";
        fs::remove_all(out);
        const std::string command = settings + quoted(POSTLENS_RESULTS) + " " + quoted(out.string()) + " " +
                                    quoted(program) + " >" + quoted(err.string()) + " 2>&1";
        EXPECT_EQ(std::system(command.c_str()), 0) << bytes_of(err);
        std::map<std::string, std::string> files;
        for (const auto& entry : fs::directory_iterator(out))
            files.emplace(entry.path().filename().string(), bytes_of(entry.path()));
        return files;
    }
    // The level of instruction sets that the program's resolvers select.
    std::string level(const std::string& program) {
        const fs::path said = folder_.path() / "said";
        const std::string command =
            "POSTLENS_SAY_CPU_LEVEL=1 " + quoted(program) + " >" + quoted(said.string());
        EXPECT_EQ(std::system(command.c_str()), 0);
        return bytes_of(said);
    }
    TemporaryFolder folder_;
};

void expect_same(const std::map<std::string, std::string>& files,
                 const std::map<std::string, std::string>& expected) {
    ASSERT_GE(expected.size(), 15U);
    EXPECT_EQ(files.size(), expected.size());
    for (const auto& [name, bytes] : expected) {
        const auto found = files.find(name);
        ASSERT_NE(found, files.end()) << name;
        EXPECT_FALSE(bytes.empty()) << name;
        EXPECT_TRUE(found->second == bytes) << name << " differs";
    }
}

TEST_F(InstructionSets, OlderProcessorsGiveTheSameBits) {
    const auto expected = results(POSTLENS_BINARY);
    ASSERT_EQ(level(POSTLENS_ANY_X86_64), "1\n");
    // As on a plain x86-64 processor, libm uses variants without fused multiply-add, and Embree those for
    // SSE2.
    expect_same(results(POSTLENS_ANY_X86_64, "GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4 "), expected);
    // On a processor without x86-64-v4, the program itself selects x86-64-v3.
    if (__builtin_cpu_supports("x86-64-v4") == 0) {
        std::cout << "This processor has no x86-64-v4: only two levels were compared.\n";
        return;
    }
    ASSERT_EQ(level(POSTLENS_X86_64_V3), "3\n");
    expect_same(results(POSTLENS_X86_64_V3), expected);
}

}  // namespace
}  // namespace postlens::test::instruction_sets_test
