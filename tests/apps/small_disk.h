// A disk of few kilobytes for one command, and running as a user who is not root.
#pragma once

#include <cstdlib>
#include <string>
#include <unistd.h>

namespace postlens::test {

/// A shell that sees an empty file system of `kilobytes` at `folder`, which must exist, and runs what follows
/// as its script. The file system is gone when the shell ends, so the script looks at what is left there
/// itself. Needs user namespaces; see `has_small_disks`.
inline std::string on_small_disk(const std::string& folder, int kilobytes, const std::string& script) {
    return "unshare --user --map-root-user --mount sh -c 'mount -t tmpfs -o size=" +
           std::to_string(kilobytes) + "k none \"$0\" || exit 99; " + script + "' '" + folder + "'";
}

/// Whether this machine lets a process have one; a container may not.
inline bool has_small_disks(const std::string& folder) {
    return std::system((on_small_disk(folder, 16, "exit 0") + " >/dev/null 2>&1").c_str()) == 0;
}

/// What makes a command run as a user who owns nothing; empty where this process is such a one already.
inline std::string as_nobody() {
    return ::geteuid() != 0 ? "" : "setpriv --reuid=65534 --regid=65534 --clear-groups ";
}

}  // namespace postlens::test
