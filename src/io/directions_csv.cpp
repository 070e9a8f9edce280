// SPDX-License-Identifier: Apache-2.0
// directions.csv. See direction_names.hpp.
#include <algorithm>
#include <array>
#include <charconv>
#include <optional>
#include <utility>

#include "io/direction_names.hpp"

namespace sateen::io {
namespace {

constexpr std::array<std::string_view, 5> kColumns = {"file", "theta_i", "phi_i",
                                                      "theta_v", "phi_v"};
constexpr std::string_view kExpectedHeader = "file,theta_i,phi_i,theta_v,phi_v";

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kBlank = " \t\r";
    const std::size_t first = text.find_first_not_of(kBlank);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

/// Takes the next line off `text`.
std::string_view next_line(std::string_view& text) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    return trimmed(line);
}

/// Cuts at commas outside quotes; "" inside quotes is a quote. Nothing if a quote is
/// open.
std::optional<std::vector<std::string>> split(std::string_view line) {
    std::vector<std::string> fields;
    for (;;) {
        std::string field;
        line = trimmed(line);
        if (!line.empty() && line.front() == '"') {
            line.remove_prefix(1);
            for (;;) {
                const std::size_t quote = line.find('"');
                if (quote == std::string_view::npos) return std::nullopt;
                field += line.substr(0, quote);
                line.remove_prefix(quote + 1);
                if (line.empty() || line.front() != '"') break;
                field += '"';
                line.remove_prefix(1);
            }
        }
        const std::size_t comma = line.find(',');
        field += trimmed(line.substr(0, comma));
        fields.push_back(std::move(field));
        if (comma == std::string_view::npos) return fields;
        line.remove_prefix(comma + 1);
    }
}

using Columns = std::array<std::size_t, kColumns.size()>;

Result<Columns> find_columns(std::string_view line, std::string_view name) {
    std::vector<std::string> titles = split(line).value_or(std::vector<std::string>());
    for (std::string& title : titles)
        for (char& c : title)
            if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    Columns columns;
    for (std::size_t i = 0; i < kColumns.size(); ++i) {
        const auto found = std::find(titles.begin(), titles.end(), kColumns[i]);
        if (found == titles.end())
            return Error{Errc::bad_format,
                         std::string(name) + ": found no column '" +
                             std::string(kColumns[i]) +
                             "' in the first line, expected the header '" +
                             std::string(kExpectedHeader) + "'"};
        columns[i] = static_cast<std::size_t>(found - titles.begin());
    }
    return columns;
}

std::optional<double> to_number(const std::string& text) {
    const char* const end = text.data() + text.size();
    const char* begin = text.data();
    if (begin != end && *begin == '+') ++begin;
    double value = 0;
    const auto [rest, code] = std::from_chars(begin, end, value);
    if (code != std::errc() || rest != end) return std::nullopt;
    return value;
}

CsvRow parse_row(std::string_view line, std::size_t line_number, const Columns& columns) {
    CsvRow row;
    row.line = line_number;
    const auto fields = split(line);
    if (!fields) {
        row.problem = "found an open quote, expected it closed on the same line";
        return row;
    }
    if (fields->size() <= *std::max_element(columns.begin(), columns.end())) {
        row.problem = "found " + std::to_string(fields->size()) +
                      " fields, expected as many as in the header";
        return row;
    }
    row.file = (*fields)[columns[0]];
    if (row.file.empty()) {
        row.problem = "found an empty file name";
        return row;
    }
    std::array<double, 4> angles = {};
    for (std::size_t i = 0; i < angles.size(); ++i) {
        const std::string& text = (*fields)[columns[i + 1]];
        const std::optional<double> value = to_number(text);
        if (!value) {
            row.problem =
                std::string(kColumns[i + 1]) + ": found '" + text + "', expected degrees";
            return row;
        }
        angles[i] = *value;
    }
    auto light = direction_key(angles[0], angles[1]);
    auto view = direction_key(angles[2], angles[3]);
    if (!light)
        row.problem = "light: " + light.error().message;
    else if (!view)
        row.problem = "view: " + view.error().message;
    else
        row.directions = {*light, *view};
    return row;
}

}  // namespace

Result<std::vector<CsvRow>> parse_directions_csv(std::string_view text,
                                                 std::string_view name) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark)
        text.remove_prefix(kByteOrderMark.size());
    std::optional<Columns> columns;
    std::vector<CsvRow> rows;
    for (std::size_t line_number = 1; !text.empty(); ++line_number) {
        const std::string_view line = next_line(text);
        if (line.empty() || line.front() == '#') continue;
        if (columns) {
            rows.push_back(parse_row(line, line_number, *columns));
        } else {
            SATEEN_TRY(columns, find_columns(line, name));
        }
    }
    if (!columns)
        return Error{Errc::bad_format, std::string(name) +
                                           ": is empty, expected the header '" +
                                           std::string(kExpectedHeader) + "'"};
    return rows;
}

}  // namespace sateen::io
