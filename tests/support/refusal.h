// Checks of the errors that calls throw.
#pragma once

#include <functional>
#include <gtest/gtest.h>
#include <string>

#include "core/error.h"

namespace postlens::test {

/// Checks that `call` throws an Error with this exit code, whose message is one line that begins with `first`
/// and contains `part`.
inline void expect_refused(const std::function<void()>& call, ExitCode code, const std::string& part = "",
                           const std::string& first = "") {
    try {
        call();
        ADD_FAILURE() << "accepted; expected: " << first << part;
    } catch (const Error& e) {
        const std::string text = e.what();
        EXPECT_EQ(e.code(), code) << text;
        EXPECT_EQ(text.rfind(first, 0), 0U) << text << "\nexpected: " << first;
        EXPECT_NE(text.find(part), std::string::npos) << text << "\nexpected: " << part;
        EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    }
}

}  // namespace postlens::test
