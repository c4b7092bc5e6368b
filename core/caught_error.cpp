#include "core/caught_error.h"

#include <exception>
#include <filesystem>
#include <new>
#include <system_error>

namespace postlens {

Error caught_error() {
    try {
        throw;
    } catch (const Error& e) {
        return e;
    } catch (const std::bad_alloc&) {
        return {ExitCode::out_of_memory, "not enough memory"};
    } catch (const std::filesystem::filesystem_error& e) {
        return {ExitCode::invalid_input, e.path1().string() + ": " + e.code().message()};
    } catch (const std::system_error& e) {
        return {ExitCode::out_of_memory,
                "cannot start a thread (" + e.code().message() + "; expected a higher limit)"};
    } catch (const std::exception& e) {
        return {ExitCode::invalid_input, std::string("internal error: ") + e.what()};
    }
}

}  // namespace postlens
