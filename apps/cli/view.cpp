// SPDX-License-Identifier: Apache-2.0
// sateen view: the viewer in the user's browser, served on this machine alone.
#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <netinet/in.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"
#include "console.hpp"
#include "sateen/io/atomic_file.hpp"
#include "sateen/io/material_file.hpp"
#include "sateen/material/file.hpp"
#include "verbs.hpp"
#include "web_page.hpp"

namespace sateen::cli {
namespace {

struct ViewArguments {
    std::string material;
    std::string port = "0";
    bool no_open = false;
    bool json = false;
};

Error socket_error(const char* what) {
    return {Errc::io, fmt::format("{}: {}", what, std::strerror(errno))};
}

Error port_error(std::uint16_t port) {
    if (errno == EADDRINUSE)
        return {Errc::io, fmt::format("--port: another program has {}, expected a free "
                                      "port, or 0 for any",
                                      port)};
    return socket_error(fmt::format("cannot serve on port {}", port).c_str());
}

/// A file descriptor that is closed in the end.
class Descriptor {
  public:
    explicit Descriptor(int number) : number_(number) {}
    Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
    Descriptor& operator=(Descriptor&&) = delete;
    ~Descriptor() {
        if (number_ >= 0) close(number_);
    }
    [[nodiscard]] int get() const { return number_; }

  private:
    int number_;
};

/// What there is to fetch; nothing else is ever served.
struct Page {
    std::string path;
    std::string type;
    std::string body;
};

/// GET and HEAD of a few pages on 127.0.0.1, one request a connection, one after the other.
class Server {
  public:
    static Result<Server> create(std::uint16_t port, std::vector<Page> pages) {
        Descriptor listener(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
        if (listener.get() < 0) return socket_error("cannot open a socket");
        const int yes = 1;
        setsockopt(listener.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        socklen_t size = sizeof address;
        auto* const generic = reinterpret_cast<sockaddr*>(&address);
        if (bind(listener.get(), generic, size) != 0 || listen(listener.get(), 16) != 0)
            return port_error(port);
        getsockname(listener.get(), generic, &size);
        return Server(std::move(listener), ntohs(address.sin_port), std::move(pages));
    }

    [[nodiscard]] std::string address() const {
        return fmt::format("http://127.0.0.1:{}/", port_);
    }

    /// Until Ctrl-C.
    void serve() const {
        while (!interrupted()) {
            pollfd waiting{listener_.get(), POLLIN, 0};
            if (poll(&waiting, 1, 200) <= 0) continue;
            const Descriptor connection(
                accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
            if (connection.get() >= 0) answer(connection.get());
        }
    }

  private:
    Server(Descriptor listener, std::uint16_t port, std::vector<Page> pages)
        : listener_(std::move(listener)), port_(port), pages_(std::move(pages)) {}

    void answer(int connection) const {
        // A silent client does not hold up the next for long.
        const timeval limit{2, 0};
        setsockopt(connection, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
        setsockopt(connection, SOL_SOCKET, SO_SNDTIMEO, &limit, sizeof limit);
        std::string request;
        constexpr std::size_t kMaxRequest = 16384;
        while (request.find("\r\n\r\n") == std::string::npos) {
            char buffer[2048];
            const ssize_t count = recv(connection, buffer, sizeof buffer, 0);
            if (count <= 0 || request.size() > kMaxRequest) return;
            request.append(buffer, static_cast<std::size_t>(count));
        }
        send_all(connection, response_to(request));
    }

    [[nodiscard]] std::string response_to(std::string_view request) const {
        const std::string_view method = request.substr(0, request.find(' '));
        const bool head = method == "HEAD";
        if (!head && method != "GET") return refusal("405 Method Not Allowed");
        // A page elsewhere that has its name resolve to this machine does not get in.
        if (!names_this_server(request)) return refusal("421 Misdirected Request");
        request.remove_prefix(method.size() + 1);
        const std::string_view path = request.substr(0, request.find_first_of(" ?\r"));
        for (const Page& page : pages_)
            if (page.path == path)
                return headers("200 OK", page.type, page.body.size()) +
                       (head ? "" : page.body);
        return refusal("404 Not Found");
    }

    [[nodiscard]] bool names_this_server(std::string_view request) const {
        for (const char* host : {"127.0.0.1", "localhost"})
            for (const char* field : {"\r\nHost: ", "\r\nhost: "})
                if (request.find(fmt::format("{}{}:{}\r\n", field, host, port_)) !=
                    std::string_view::npos)
                    return true;
        return false;
    }

    static std::string headers(std::string_view status, std::string_view type,
                               std::size_t bytes) {
        return fmt::format(
            "HTTP/1.1 {}\r\nContent-Type: {}\r\nContent-Length: {}\r\nCache-Control: "
            "no-store\r\n"
            "X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
            status, type, bytes);
    }

    static std::string refusal(std::string_view status) {
        return headers(status, "text/plain", status.size() + 1) + std::string(status) +
               "\n";
    }

    static void send_all(int connection, std::string_view text) {
        while (!text.empty()) {
            const ssize_t sent = send(connection, text.data(), text.size(), MSG_NOSIGNAL);
            if (sent <= 0) return;
            text.remove_prefix(static_cast<std::size_t>(sent));
        }
        shutdown(connection, SHUT_WR);
    }

    Descriptor listener_;
    std::uint16_t port_;
    std::vector<Page> pages_;
};

/// Asks the desktop to open an address; where there is none, nothing happens.
void open_in_browser(const std::string& address) {
    if (std::getenv("DISPLAY") == nullptr && std::getenv("WAYLAND_DISPLAY") == nullptr)
        return;
    std::string program = "xdg-open";
    std::string argument = address;
    char* const words[] = {program.data(), argument.data(), nullptr};
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    for (const int stream : {STDOUT_FILENO, STDERR_FILENO})
        posix_spawn_file_actions_addopen(&actions, stream, "/dev/null", O_WRONLY, 0);
    pid_t child = 0;
    (void)posix_spawnp(&child, program.c_str(), &actions, nullptr, words, environ);
    posix_spawn_file_actions_destroy(&actions);
}

Result<void> run_view(const ViewArguments& arguments) {
    // Read and checked first: a damaged file is reported here, not in the browser.
    SATEEN_TRY(const Material material, load_material(arguments.material));
    SATEEN_TRY(const auto file, read_file(arguments.material, kMaxPayloadBytes));
    SATEEN_TRY(std::string page, viewer_page());
    SATEEN_TRY(const Server server,
               Server::create(static_cast<std::uint16_t>(std::stoul(arguments.port)),
                              {{"/", "text/html; charset=utf-8", std::move(page)},
                               {"/material.sateen", "application/octet-stream",
                                std::string(file.begin(), file.end())}}));
    const std::string address = server.address() + "?url=material.sateen";
    if (arguments.json)
        print_json({{"url", address}});
    else
        fmt::print("{}\n", address);
    std::fflush(stdout);
    if (!arguments.no_open) open_in_browser(address);
    fmt::print(stderr, "serving {}; Ctrl-C ends it\n",
               one_line(std::filesystem::path(arguments.material).filename().string()));
    server.serve();
    return {};
}

}  // namespace

Verb add_view(CLI::App& program) {
    auto arguments = std::make_shared<ViewArguments>();
    CLI::App* verb =
        program.add_subcommand("view", "Show a material in the browser, served locally");
    add_material(*verb, arguments->material);
    verb->add_option("--port", arguments->port, "Port on 127.0.0.1; 0 for any free one")
        ->type_name("N")
        ->capture_default_str()
        ->check(whole_number_up_to(65535));
    verb->add_flag("--no-open", arguments->no_open, "Do not open a browser");
    verb->add_flag("--json", arguments->json, "Print the address as JSON on stdout");
    verb->set_help_flag("-h,--help", "Print this help");
    verb->footer("Example: sateen view corduroy.sateen");
    return {verb, [arguments] { return run_view(*arguments); }};
}

}  // namespace sateen::cli
