// The message of an error that must be thrown.
#pragma once

#include <gtest/gtest.h>
#include <string>

#include "core/error.h"

namespace postlens::test {

/// The message of the Error with exit code `code` that `action` must throw.
template <typename Action>
std::string error_text(ExitCode code, const Action& action) {
    try {
        action();
    } catch (const Error& error) {
        EXPECT_EQ(error.code(), code);
        return error.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return {};
}

}  // namespace postlens::test
