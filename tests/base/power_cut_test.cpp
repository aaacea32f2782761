// What is on a disk after a power cut: each call is noted, and the cut is made after every one of them.

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/output_file.h"
#include "base/output_folder.h"
#include "tests/base/failing_calls.h"
#include "tests/support/folder.h"

namespace headpin::base {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// Names and contents; a folder has none.
using Tree = std::map<std::string, std::string>;
constexpr const char* kFolder = "<folder>";

Tree tree_of(const fs::path& top) {
  Tree tree;
  for (const auto& entry : fs::recursive_directory_iterator(top)) {
    tree[entry.path()] = entry.is_directory() ? kFolder : slurp(entry.path());
  }
  return tree;
}

/// A disk that has, at a power cut, the names of all calls up to one of them, in order, as a
/// file system with a journal does; of a file's bytes those that were synced, or those and the rest.
class Disk {
 public:
  Disk(Tree before, std::vector<Change> changes)
      : before_(std::move(before)), changes_(std::move(changes)) {}

  /// All states that a cut can leave.
  std::set<Tree> states() const {
    std::set<Tree> all;
    for (std::size_t calls = 0; calls <= changes_.size(); ++calls) add_states(calls, all);
    return all;
  }
  /// Those that one after the last call can leave.
  std::set<Tree> states_after_all() const {
    std::set<Tree> all;
    add_states(changes_.size(), all);
    return all;
  }

 private:
  void add_states(std::size_t calls, std::set<Tree>& all) const {
    for (std::size_t names = synced_names(calls); names <= calls; ++names) {
      for (const bool all_bytes : {false, true}) all.insert(state(calls, names, all_bytes));
    }
  }

  struct File {
    std::string now, synced;
  };
  using Files = std::map<std::string, std::shared_ptr<File>>;

  static bool is_in(const std::string& path, const std::string& folder) {
    return path.starts_with(folder + "/");
  }
  static bool changes_a_name(const Change& c) {
    return c.kind == Change::kCreate || c.kind == Change::kMakeFolder ||
           c.kind == Change::kRename || c.kind == Change::kRemove;
  }
  /// Up to which call the names are on the disk for certain: to the last one in a folder that was
  /// synced after it.
  std::size_t synced_names(std::size_t calls) const {
    std::size_t certain = 0;
    for (std::size_t i = 0; i < calls; ++i) {
      const Change& sync = changes_[i];
      if (sync.kind == Change::kSyncAll) certain = i;
      if (sync.kind != Change::kSync) continue;
      for (std::size_t j = certain; j < i; ++j) {
        const Change& c = changes_[j];
        if (!changes_a_name(c)) continue;
        const bool here =
            fs::path(c.path).parent_path() == sync.path ||
            (c.kind == Change::kRename && fs::path(c.other).parent_path() == sync.path);
        if (here) certain = j + 1;
      }
    }
    return certain;
  }

  static void change_name(const Change& c, Files& files) {
    if (c.kind == Change::kCreate) files[c.path] = std::make_shared<File>();
    if (c.kind == Change::kMakeFolder) {
      files[c.path] = std::make_shared<File>(File{kFolder, kFolder});
    }
    if (c.kind == Change::kRemove) files.erase(c.path);
    if (c.kind != Change::kRename) return;
    Files moved;
    std::erase_if(files, [&](const auto& entry) {
      if (entry.first != c.path && !is_in(entry.first, c.path)) return false;
      moved[c.other + entry.first.substr(c.path.size())] = entry.second;
      return true;
    });
    for (const auto& [path, file] : moved) files[path] = file;
  }
  static void change_bytes(const Change& c, Files& files) {
    if (c.kind == Change::kSyncAll) {
      for (const auto& [path, file] : files) file->synced = file->now;
    }
    const auto found = files.find(c.path);
    if (found == files.end()) return;
    File& file = *found->second;
    if (c.kind == Change::kSync) file.synced = file.now;
    if (c.kind == Change::kCut) file.now.resize(c.at);
    if (c.kind == Change::kWrite) {
      file.now.resize(std::max(file.now.size(), c.at + c.other.size()));
      file.now.replace(c.at, c.other.size(), c.other);
    }
  }

  Tree state(std::size_t calls, std::size_t names, bool all_bytes) const {
    Files now;
    for (const auto& [path, text] : before_) now[path] = std::make_shared<File>(File{text, text});
    Files on_disk = now;
    for (std::size_t i = 0; i < calls; ++i) {
      change_name(changes_[i], now);
      change_bytes(changes_[i], now);
      if (i >= names) continue;
      if (changes_[i].kind == Change::kCreate || changes_[i].kind == Change::kMakeFolder) {
        on_disk[changes_[i].path] = now[changes_[i].path];
      } else {
        change_name(changes_[i], on_disk);
      }
    }
    Tree tree;
    for (const auto& [path, file] : on_disk) tree[path] = all_bytes ? file->now : file->synced;
    return tree;
  }

  Tree before_;
  std::vector<Change> changes_;
};

void put_back(const fs::path& top, const Tree& tree) {
  for (const auto& entry : fs::directory_iterator(top)) fs::remove_all(entry);
  for (const auto& [path, text] : tree) {  // a folder comes before what is in it
    if (text == kFolder) {
      fs::create_directory(path);
    } else {
      spit(path, text);
    }
  }
}

TEST(PowerCut, LeavesTheOldFileOrTheNewOne) {
  const TemporaryFolder folder;
  const std::string path = folder / "out";
  for (const bool there : {false, true}) {
    if (there) spit(path, "old");
    const Tree before = tree_of(folder.path());
    const std::vector<Change> changes = changes_of([&] {
      OutputFile file(path, {.overwrite = true});
      file.write("the ", 4);
      file.write("new", 3);
      file.commit();
    });
    const Disk disk(before, changes);
    std::set<std::string> found;
    for (const Tree& tree : disk.states()) {
      const auto out = tree.find(path);
      found.insert(out == tree.end() ? "nothing" : out->second);
    }
    EXPECT_EQ(found, (std::set<std::string>{there ? "old" : "nothing", "the new"}));
    fs::remove(path);
  }
}

TEST(PowerCut, LeavesOfALiveFileWhatWasSyncedAndInTheEndAll) {
  const TemporaryFolder folder;
  const std::string path = folder / "out";
  const auto found = [&](bool whole) {
    fs::remove(path);
    const std::vector<Change> changes = changes_of([&] {
      OutputFile file(path, {.live = true});
      file.write("first", 5);
      file.sync();
      file.write("second", 6);
      if (whole) file.commit();
    });
    std::set<std::string> all;
    for (const Tree& tree : Disk({}, changes).states_after_all()) all.insert(tree.at(path));
    return all;
  };
  EXPECT_EQ(found(false), (std::set<std::string>{"first", "firstsecond"}));
  EXPECT_EQ(found(true), (std::set<std::string>{"firstsecond"}));
}

TEST(PowerCut, LeavesTheOldFilesOfAFolderOrTheNewOnes) {
  const TemporaryFolder folder;
  const std::string out = folder / "out";
  const auto write = [&](const std::vector<std::string>& names, const std::string& text) {
    OutputFolder results(out, {.overwrite = true, .others = {}});
    for (const std::string& name : names) {
      OutputFile file(results.file(name), {.overwrite = true, .durable = false});
      file.write(text.data(), text.size());
      file.commit();
    }
    results.commit("index");
  };
  write({"1.png", "2.png", "index"}, "old");
  const Tree before = tree_of(folder.path());
  const std::vector<Change> changes = changes_of([&] {
    write({"2.png", "3.png", "index"}, "new");
  });
  const std::set<Tree> states = Disk(before, changes).states();
  EXPECT_GT(states.size(), 50u);
  std::set<std::string> found;
  for (const Tree& state : states) {
    put_back(folder.path(), state);
    // A list that did not reach the disk names nothing, and then nothing is removed.
    EXPECT_THAT(complaint([&] { OutputFolder(out, {}); }),
                testing::AnyOf(HasSubstr("exists already"), HasSubstr(".headpin.part: holds")));
    std::string now;
    for (const auto& [path, text] : tree_of(out)) {
      const fs::path name = fs::path(path).lexically_relative(out);
      if (!name.string().starts_with(".")) now += name.string() + " " + text + "; ";
    }
    found.insert(now);
  }
  EXPECT_EQ(found, (std::set<std::string>{"1.png old; 2.png old; index old; ",
                                          "2.png new; 3.png new; index new; "}));
}

}  // namespace
}  // namespace headpin::base
