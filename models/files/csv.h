#pragma once

#include <string_view>
#include <vector>

namespace hvp::files {

// The cells of a line of a CSV file, which `delimiter` parts: at least one, views into `line`,
// without the blanks around them. A cell in double quotes may have the delimiter inside (RFC 4180);
// it comes without the quotes, and a doubled quote inside stays doubled. A quote that is not closed
// on the line is a character as any other.
std::vector<std::string_view> csv_cells(std::string_view line, char delimiter = ',');
// The same into a list of the caller's, for a table of many lines.
void csv_cells(std::string_view line, char delimiter, std::vector<std::string_view>& cells);

// Tab or semicolon where the line has one outside quotes, in this order; else a comma.
char csv_delimiter(std::string_view header);

// Without blanks, tabs and carriage returns around it.
std::string_view trimmed(std::string_view text);

}  // namespace hvp::files
