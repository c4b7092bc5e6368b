// Any exception as an Error.
#include "core/caught_error.h"

#include <filesystem>
#include <gtest/gtest.h>
#include <new>
#include <stdexcept>
#include <system_error>

namespace postlens::test::caught_error_test {
namespace {

template <typename Exception>
void is_error(const Exception& thrown, ExitCode code, const std::string& text) {
    try {
        throw thrown;
    } catch (...) {
        const Error e = caught_error();
        EXPECT_EQ(e.code(), code) << text;
        EXPECT_EQ(e.what(), text);
    }
}

TEST(CaughtError, HasTheCodeOfItsKind) {
    is_error(Error(ExitCode::cannot_write, "a.exr: cannot write"), ExitCode::cannot_write,
             "a.exr: cannot write");
    is_error(std::bad_alloc(), ExitCode::out_of_memory, "not enough memory");
    is_error(std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again)),
             ExitCode::out_of_memory,
             "cannot start a thread (Resource temporarily unavailable; expected a higher limit)");
    is_error(std::filesystem::filesystem_error("cannot look", "a.exr",
                                               std::make_error_code(std::errc::permission_denied)),
             ExitCode::invalid_input, "a.exr: Permission denied");
    is_error(std::logic_error("odd"), ExitCode::invalid_input, "internal error: odd");
}

}  // namespace
}  // namespace postlens::test::caught_error_test
