// Copyright 2026 the lamina authors. SPDX-License-Identifier: Apache-2.0
// The plan of the house: src/lamina/CMakeLists.txt and those below it name the rooms in their order
// and what each links. The code may include no more than that.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const fs::path root = fs::path(LAMINA_SOURCE_DIR) / "src/lamina";

std::string text_of(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

std::vector<std::string> all_matches(const std::string& text, const std::string& pattern) {
  const std::regex regex(pattern);
  std::vector<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), regex), end; i != end; ++i)
    found.push_back((*i)[1]);
  return found;
}

/// The words after a keyword of a CMake call, up to the next keyword or its end.
std::vector<std::string> words_after(const std::string& call, const std::string& keyword) {
  std::vector<std::string> words;
  std::istringstream stream(call);
  bool is_here = false;
  for (std::string word; stream >> word;) {
    const bool ends = word.ends_with(')');
    if (ends) word.pop_back();
    if (word == keyword)
      is_here = true;
    else if (std::regex_match(word, std::regex("[A-Z_]+")))
      is_here = false;
    else if (is_here && !word.empty())
      words.push_back(word);
    if (ends) break;
  }
  return words;
}

struct Room {
  std::string folder;  ///< below src/lamina
  std::string target;  ///< of CMake; a room with folders of its own shares it with them
};

struct Plan {
  std::vector<Room> rooms;                             ///< in their order
  std::map<std::string, std::set<std::string>> links;  ///< [target]

  [[nodiscard]] std::optional<std::size_t> place_of(const std::string& folder) const {
    const auto found = std::ranges::find(rooms, folder, &Room::folder);
    if (found == rooms.end()) return std::nullopt;
    return static_cast<std::size_t>(found - rooms.begin());
  }
};

void read_plan(const std::string& folder, Plan& plan) {
  const std::string text = text_of(root / folder / "CMakeLists.txt");
  for (const std::string& sub : all_matches(text, R"(add_subdirectory\(([\w/]+)\))"))
    read_plan(folder.empty() ? sub : folder + "/" + sub, plan);
  const std::size_t at = text.find("lamina_library(");
  if (at == std::string::npos) return;
  const std::string call = text.substr(at + std::string("lamina_library(").size());
  const std::string target =
      std::regex_replace(call.substr(0, call.find('\n')), std::regex(R"(\)|\s)"), "");
  // What lies below a room is its foundation, but for optics, whose rough surfaces build on it.
  const std::vector<std::string> below = words_after(call, "FOLDERS");
  const bool is_first = folder == "layers/optics";
  if (is_first) plan.rooms.push_back({folder, target});
  for (const std::string& sub : below) plan.rooms.push_back({folder + "/" + sub, target});
  if (!is_first) plan.rooms.push_back({folder, target});
  for (const std::string& link : words_after(call, "LINKS"))
    plan.links[target].insert(link.substr(std::string("lamina::").size()));
}

const Plan& plan() {
  static const Plan plan = [] {
    Plan read;
    read_plan("", read);
    return read;
  }();
  return plan;
}

struct Source {
  fs::path file;  ///< below src/lamina
  std::string room;
  std::vector<std::string> included;  ///< files of lamina, below src/lamina
  std::vector<std::string> others;    ///< <...>
};

std::string room_of(const fs::path& file) {
  fs::path folder = file.parent_path();
  if (folder.filename() == "internal") folder = folder.parent_path();
  return folder.string();
}

const std::vector<Source>& sources() {
  static const std::vector<Source> sources = [] {
    std::vector<Source> found;
    for (const auto& entry : fs::recursive_directory_iterator(root)) {
      if (entry.path().extension() != ".h" && entry.path().extension() != ".cpp") continue;
      const fs::path file = fs::relative(entry.path(), root);
      const std::string text = text_of(entry.path());
      found.push_back({file, room_of(file), all_matches(text, R"re(#include "lamina/([^"]+)")re"),
                       all_matches(text, R"(#include <([^>]+)>)")});
    }
    return found;
  }();
  return sources;
}

TEST(Rooms, IncludeOnlyRoomsAboveThem) {
  EXPECT_GT(sources().size(), 300u);
  for (const Source& source : sources()) {
    const auto place = plan().place_of(source.room);
    ASSERT_TRUE(place) << source.file << " lies in no room that a CMakeLists.txt names";
    for (const std::string& included : source.included) {
      const auto other = plan().place_of(room_of(included));
      ASSERT_TRUE(other) << source.file << " includes " << included;
      EXPECT_LE(*other, *place) << source.file << " includes " << included;
    }
  }
}

// Rooms of one wing stand together, and wings in the order of the page for newcomers.
TEST(Wings, StandInTheirOrder) {
  const std::vector<std::string> expected = {"base",  "layers", "solve",    "skin",
                                             "scene", "render", "exchange", "reproduction"};
  std::vector<std::string> wings;
  for (const Room& room : plan().rooms) {
    const std::string wing = room.folder.substr(0, room.folder.find('/'));
    if (wings.empty() || wings.back() != wing) wings.push_back(wing);
  }
  EXPECT_EQ(wings, expected);
  const std::string page = text_of(fs::path(LAMINA_SOURCE_DIR) / "docs/architecture.md");
  std::size_t last = 0;
  for (const std::string& wing : expected) {
    const std::size_t at = page.find("| `" + wing + "` | ");
    ASSERT_NE(at, std::string::npos) << wing;
    EXPECT_GT(at, last) << wing;
    last = at;
  }
}

TEST(Rooms, LinkWhatTheyInclude) {
  for (const Source& source : sources()) {
    const std::string& target = plan().rooms[*plan().place_of(source.room)].target;
    for (const std::string& included : source.included) {
      const std::string& other = plan().rooms[*plan().place_of(room_of(included))].target;
      EXPECT_TRUE(other == target || plan().links.at(target).contains(other))
          << source.file << " includes " << included << ", but lamina::" << target
          << " does not link lamina::" << other;
    }
  }
}

TEST(Rooms, KeepTheirInternalFilesToThemselves) {
  for (const Source& source : sources())
    for (const std::string& included : source.included) {
      if (included.find("/internal/") == std::string::npos) continue;
      EXPECT_EQ(room_of(included), source.room) << source.file << " includes " << included;
    }
}

TEST(Rooms, KnowOfOtherLibrariesOnlyWhatIsTheirs) {
  const std::map<std::string, std::set<std::string>> owners = {
      {"embree", {"render/geometry"}},   {"OpenEXR/", {"base/image/files"}},
      {"Imath/", {"base/image/files"}},  {"png.h", {"base/image/files"}},
      {"tiff", {"base/image/files"}},    {"libraw/", {"base/image/files"}},
      {"lcms2", {"base/image/files"}},   {"zlib.h", {"base/image/files"}},
      {"tbb/", {"base/core"}},           {"OpenColorIO/", {"base/image/files"}},
      {"jpeglib", {"base/image/files"}}, {"nlohmann/", {"base/io"}},
  };
  for (const Source& source : sources())
    for (const std::string& other : source.others)
      for (const auto& [start, rooms] : owners) {
        if (!other.starts_with(start)) continue;
        EXPECT_TRUE(rooms.contains(source.room)) << source.file << " includes " << other;
      }
}

TEST(Command, NeedsTheRendererForRenderAlone) {
  int files = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(LAMINA_SOURCE_DIR) / "cli")) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with("render_") || name == "CMakeLists.txt") continue;
    ++files;
    EXPECT_EQ(text_of(entry.path()).find("#include \"lamina/render/"), std::string::npos) << name;
  }
  EXPECT_GT(files, 20);
}

// Depth-first over modules: a header, its source and what of it is inline (-inl.h) are one. A
// source may use an internal header of its own room that knows its header.
TEST(Modules, IncludeOneAnotherInNoLoop) {
  std::map<std::string, std::set<std::string>> includes;
  for (const Source& source : sources()) {
    const auto module = [](fs::path file) {
      return std::regex_replace(file.replace_extension().string(), std::regex("-inl$"), "");
    };
    for (const std::string& included : source.included) {
      const bool is_own = source.file.extension() == ".cpp" && room_of(included) == source.room &&
                          included.find("/internal/") != std::string::npos;
      if (!is_own && module(included) != module(source.file))
        includes[module(source.file)].insert(module(included));
    }
  }
  enum class State { unknown, open, done };
  std::map<std::string, State> states;
  std::vector<std::string> way;
  const std::function<void(const std::string&)> visit = [&](const std::string& module) {
    State& state = states[module];
    if (state == State::done) return;
    way.push_back(module);
    if (state == State::open) {
      std::string loop;
      for (auto i = std::ranges::find(way, module); i != way.end(); ++i) loop += " " + *i;
      ADD_FAILURE() << "a loop:" << loop;
    } else {
      state = State::open;
      for (const std::string& other : includes[module]) visit(other);
      states[module] = State::done;
    }
    way.pop_back();
  };
  for (const auto& [module, ignored] : std::map(includes)) visit(module);
}

TEST(Rooms, AreSmall) {
  std::map<std::string, std::set<std::string>> modules;
  std::map<std::string, std::ptrdiff_t> lines;
  for (const Source& source : sources()) {
    modules[source.room].insert(source.file.stem().string());
    const std::string text = text_of(root / source.file);
    lines[source.room] += std::ranges::count(text, '\n');
  }
  for (const Room& room : plan().rooms) {
    EXPECT_LE(modules[room.folder].size(), 30u) << room.folder;
    EXPECT_LE(lines[room.folder], 5000) << room.folder;
  }
}

}  // namespace
