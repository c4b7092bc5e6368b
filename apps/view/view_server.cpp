#include "apps/view/view_server.h"

#include <fcntl.h>
#include <httplib.h>
#include <openssl/crypto.h>
#include <sys/random.h>

#include "apps/view/view_page.h"

namespace postlens {
namespace {

/// Returns 128 random bits as 32 hexadecimal digits.
std::string random_token() {
    std::array<unsigned char, 16> bytes{};
    if (::getrandom(bytes.data(), bytes.size(), 0) != static_cast<ssize_t>(bytes.size()))
        fail(ExitCode::invalid_input, "no random numbers from the system");
    std::string out;
    for (const unsigned char b : bytes) out += fmt::format("{:02x}", b);
    return out;
}

/// Returns true if `host`, the address in the browser's request, is this computer (a loopback address). Any
/// port is accepted: through a tunnel (`ssh -L`), the browser uses another port than the server.
bool is_local(const std::string& host) {
    const std::size_t colon = host.rfind(':');
    const bool has_port = colon != std::string::npos && host.find(']', colon) == std::string::npos;
    const std::string name = has_port ? host.substr(0, colon) : host;
    if (has_port && host.find_first_not_of("0123456789", colon + 1) != std::string::npos) return false;
    return name == "127.0.0.1" || name == "localhost" || name == "[::1]";
}

/// Returns true if the request comes from the viewer's own page, or from the address bar of the browser.
bool is_ours(const httplib::Request& request) {
    const std::string host = request.get_header_value("Host");
    if (!is_local(host)) return false;
    if (request.has_header("Origin") && request.get_header_value("Origin") != "http://" + host) return false;
    const std::string site = request.get_header_value("Sec-Fetch-Site");
    return site.empty() || site == "same-origin" || site == "none";
}

ViewParameters parameters_of(const httplib::Request& request) {
    ViewParameters out;
    for (const auto& [name, value] : request.params) out[name] = value;
    return out;
}

void send(ViewReply&& reply, httplib::Response& response) {
    response.status = reply.status;
    response.body = std::move(reply.body);
    response.set_header("Content-Type", reply.type);
}

}  // namespace

struct ViewServer::Impl {
    httplib::Server server;
    std::string token = random_token(), address;

    /// Returns the part of the URL's path after "/TOKEN/", or nothing if the token is wrong. The comparison
    /// takes constant time, so as not to reveal the token.
    [[nodiscard]] std::optional<std::string> behind_token(const std::string& path) const {
        if (path.size() < token.size() + 2 || path[0] != '/' || path[token.size() + 1] != '/')
            return std::nullopt;
        if (CRYPTO_memcmp(path.data() + 1, token.data(), token.size()) != 0) return std::nullopt;
        return path.substr(token.size() + 2);
    }

    void answer(ViewSession& session, const httplib::Request& request, httplib::Response& response) const {
        response.set_header(
            "Content-Security-Policy",
            "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
            "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
        response.set_header("X-Content-Type-Options", "nosniff");
        response.set_header("Referrer-Policy", "no-referrer");
        response.set_header("Cross-Origin-Resource-Policy", "same-origin");
        response.set_header("Cache-Control", "no-store");
        const std::optional<std::string> name = is_ours(request) ? behind_token(request.path) : std::nullopt;
        if (!name) {
            response.status = 404;
            response.set_content("not here\n", "text/plain");
            return;
        }
        if (const std::optional<PageFile> file = page_file(name->empty() ? "index.html" : *name)) {
            response.set_content(file->text.data(), file->text.size(), file->type);
        } else if (*name == "frame") {
            send(session.frame(), response);
        } else if (*name == "picture") {
            send(session.picture(parameters_of(request)), response);
        } else if (*name == "coarse") {
            send(session.coarse_picture(parameters_of(request)), response);
        } else if (*name == "rays") {
            send(session.rays(parameters_of(request)), response);
        } else if (*name == "pixel") {
            send(session.pixel(parameters_of(request)), response);
        } else if (*name == "depths") {
            send(session.depths(), response);
        } else if (*name == "causes") {
            send(session.causes(parameters_of(request)), response);
        } else if (*name == "drop_causes") {
            send(session.drop_causes(), response);
        } else if (*name == "save") {
            send(session.save(parameters_of(request)), response);
        } else {
            response.status = 404;
            response.set_content("not here\n", "text/plain");
        }
    }
};

ViewServer::ViewServer(ViewSession& session, int port) : impl_(std::make_unique<Impl>()) {
    httplib::Server& server = impl_->server;
    // An idle connection occupies a thread until its timeout. Many threads and short timeouts keep the server
    // responsive.
    constexpr std::size_t threads = 32;
    constexpr time_t patience_s = 2;
    server.new_task_queue = [] { return new httplib::ThreadPool(threads); };  // NOLINT: the server deletes it
    server.set_read_timeout(patience_s);
    server.set_write_timeout(10);  // in seconds, for each part of an image sent through a slow tunnel
    server.set_keep_alive_timeout(patience_s);
    server.set_payload_max_length(0);
    server.set_tcp_nodelay(true);
    // FD_CLOEXEC prevents the browser process, which this program starts, from inheriting the socket.
    // SO_REUSEADDR lets the viewer use a port again soon after it was closed. SO_REUSEPORT, which the HTTP
    // library sets by default, is not set, because another program could then use the same port.
    server.set_socket_options([](socket_t socket) {
        ::fcntl(socket, F_SETFD, FD_CLOEXEC);
        const int yes = 1;
        ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
    server.Get(".*", [this, &session](const httplib::Request& request, httplib::Response& response) {
        impl_->answer(session, request, response);
    });
    server.set_exception_handler(
        [](const httplib::Request&, httplib::Response& response, const std::exception_ptr&) {
            response.status = 500;
            response.set_content("internal error\n", "text/plain");
        });
    const char* here = "127.0.0.1";
    const int bound =
        port == 0 ? server.bind_to_any_port(here) : (server.bind_to_port(here, port) ? port : -1);
    if (bound <= 0)
        fail(ExitCode::wrong_arguments, "--port: cannot be used (got {}; expected a free port)", port);
    impl_->address = fmt::format("http://{}:{}/{}/", here, bound, impl_->token);
}

ViewServer::~ViewServer() = default;

const std::string& ViewServer::address() const {
    return impl_->address;
}

void ViewServer::serve() {
    impl_->server.listen_after_bind();
}

void ViewServer::stop() {
    impl_->server.stop();
}

}  // namespace postlens
