// SPDX-License-Identifier: Apache-2.0
// The viewer's page. See web_page.hpp.
#include "web_page.hpp"

#include <fmt/format.h>

#include <cstddef>
#include <filesystem>
#include <system_error>

#include "html.hpp"
#include "sateen/io/atomic_file.hpp"

namespace sateen::cli {
namespace {

constexpr std::size_t kMaxPageBytes = std::size_t{16} << 20U;
constexpr std::string_view kPlace = "<!--sateen-material-->";

}  // namespace

Result<std::string> viewer_page() {
    std::error_code failure;
    const std::filesystem::path program =
        std::filesystem::read_symlink("/proc/self/exe", failure);
    const std::filesystem::path page =
        program.parent_path().parent_path() / "share" / "sateen" / "viewer.html";
    if (failure || !std::filesystem::exists(page, failure))
        return Error{Errc::io,
                     "the viewer is not built: run tools/build_wasm.sh and "
                     "tools/build_viewer.sh, which put it at " +
                         page.string()};
    SATEEN_TRY(const auto bytes, read_file(page.string(), kMaxPageBytes));
    return std::string(bytes.begin(), bytes.end());
}

Result<std::string> page_with_material(std::string page, std::string_view name,
                                       std::span<const std::uint8_t> file) {
    const std::size_t at = page.find(kPlace);
    if (at == std::string::npos)
        return Error{Errc::bad_format,
                     "the viewer's page has no place for a material, expected one from "
                     "tools/build_viewer.sh"};
    page.replace(at, kPlace.size(),
                 fmt::format("<script type=\"text/plain\" id=\"sateen-material\" "
                             "data-name=\"{}\">{}</script>",
                             html::escaped(name), html::base64(file)));
    return page;
}

}  // namespace sateen::cli
