#include "paracal/io/store.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include <filesystem>

#include "io/files/stored.hpp"
#include "paracal/error.hpp"

namespace paracal::io::store_test {
namespace {

using testing::HasSubstr, testing::ThrowsMessage;

class Stores : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder); }
  void TearDown() override { std::filesystem::remove_all(folder); }

  std::string text(const char* name) const { return read_file(folder / name).text; }
  std::ptrdiff_t entries() const { return std::distance(std::filesystem::directory_iterator(folder), {}); }
  struct stat status(const char* name) const {
    struct stat found {};
    EXPECT_EQ(stat((folder / name).c_str(), &found), 0);
    return found;
  }

  std::filesystem::path folder = std::filesystem::temp_directory_path() / ("paracal-store-" + std::to_string(getpid()));
};

/// As long as what waits in memory, and longer.
TEST_F(Stores, FilesComeTogether) {
  for (const std::size_t length : {1u, 1u << 16, 1u << 20}) {
    Store store;
    const TextSink one = store.begin(folder / "one");
    for (std::size_t k = 0; k < length; k += 1024) one(std::string(std::min(length - k, std::size_t{1024}), 'x'));
    store.write(folder / "other", "y");
    EXPECT_LE(entries(), length == 1 ? 0 : 2);
    store.commit();
    EXPECT_EQ(text("one"), std::string(length, 'x'));
    EXPECT_EQ(text("other"), "y");
    EXPECT_EQ(entries(), 2);
  }
}

TEST_F(Stores, OneThatFailsTakesTheOthersBack) {
  write_file(folder / "one", "earlier");
  write_file(folder / "other", "earlier, too");
  write_file(folder / "taken", "");
  Store store;
  store.write(folder / "one", "new");
  store.write(folder / "fresh", "new");
  store.write(folder / "other", "new", {.kept_as = "taken"});
  EXPECT_THAT([&] { store.commit(); }, ThrowsMessage<Error>(HasSubstr("taken: cannot be written: File exists")));
  EXPECT_EQ(text("one"), "earlier");
  EXPECT_EQ(text("other"), "earlier, too");
  EXPECT_EQ(entries(), 3);
}

TEST_F(Stores, WhatIsReplacedIsKeptAndHandsOnWhatItHad) {
  write_file(folder / "file", "earlier");
  const std::filesystem::path path = folder / "file";
  const bool is_root = geteuid() == 0;
  ASSERT_EQ(chown(path.c_str(), is_root ? 12345 : geteuid(), is_root ? 54321 : getegid()), 0);
  ASSERT_EQ(chmod(path.c_str(), 0600), 0);
  const bool has_attributes = setxattr(path.c_str(), "user.note", "mine", 4, 0) == 0;
  const struct stat before = status("file");
  Store store;
  store.write(path, "new", {.sha256 = sha256("earlier"), .kept_as = "kept"});
  store.commit();
  EXPECT_EQ(text("file"), "new");
  EXPECT_EQ(text("kept"), "earlier");
  for (const char* name : {"file", "kept"}) {
    const struct stat after = status(name);
    EXPECT_EQ(after.st_mode & 07777, 0600u) << name;
    EXPECT_EQ(after.st_uid, before.st_uid) << name;
    EXPECT_EQ(after.st_gid, before.st_gid) << name;
    std::string note(4, ' ');
    if (!has_attributes) continue;  // a file system without
    EXPECT_EQ(getxattr((folder / name).c_str(), "user.note", note.data(), note.size()), 4) << name;
    EXPECT_EQ(note, "mine") << name;
  }
  ASSERT_EQ(chmod(path.c_str(), 0754), 0);
  write_file(path, "newer");
  EXPECT_EQ(status("file").st_mode & 07777, 0754u);
  EXPECT_EQ(entries(), 2);
}

TEST_F(Stores, WhatChangedSinceItWasReadStays) {
  const auto replace = [&] {
    Store store;
    store.write(folder / "file", "new", {.sha256 = sha256("as read"), .kept_as = "kept"});
    store.commit();
  };
  const auto is_refused = ThrowsMessage<Error>(HasSubstr("file: expected the file as it was read, got a changed one"));
  EXPECT_THAT(replace, is_refused);
  EXPECT_EQ(entries(), 0);
  write_file(folder / "file", "an edit");
  EXPECT_THAT(replace, is_refused);
  EXPECT_EQ(text("file"), "an edit");
  write_file(folder / "file", "as read");
  const int editor = open((folder / "file").c_str(), O_WRONLY | O_APPEND);
  EXPECT_THAT(replace, is_refused) << "somebody is about to write";
  EXPECT_EQ(write(editor, " and more", 9), 9);
  close(editor);
  EXPECT_EQ(text("file"), "as read and more");
  EXPECT_EQ(entries(), 1);
  write_file(folder / "file", "as read");
  replace();
  EXPECT_EQ(text("file"), "new");
}

TEST_F(Stores, NewFilesReplaceNone) {
  EXPECT_TRUE(write_new_file(folder / "file", "first"));
  EXPECT_FALSE(write_new_file(folder / "file", "second"));
  EXPECT_EQ(text("file"), "first");
  EXPECT_EQ(entries(), 1);
}

TEST_F(Stores, LinksStayAndWhatTheyPointToIsReplaced) {
  write_file(folder / "file", "earlier");
  std::filesystem::create_symlink("file", folder / "link");
  std::filesystem::create_symlink("none", folder / "dangling");
  write_file(folder / "link", "new");
  write_file(folder / "dangling", "made");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
  EXPECT_EQ(text("file"), "new");
  EXPECT_EQ(text("none"), "made");
}

/// In a folder where everybody can write, somebody else may make a link to what only root can write or read.
TEST_F(Stores, WhatOthersMakeInASharedFolderIsNotUsed) {
  if (geteuid() != 0) return;  // nobody else can give a link away
  constexpr uid_t kNobody = 65534;
  const auto give_away = [](const std::filesystem::path& path) {
    ASSERT_EQ(lchown(path.c_str(), kNobody, kNobody), 0) << path;
  };
  const std::filesystem::path shared = folder / "shared";
  std::filesystem::create_directory(shared);
  std::filesystem::create_directory(folder / "own");
  ASSERT_EQ(chmod(shared.c_str(), 01777), 0);
  write_file(folder / "secret", "private");
  write_file(shared / "theirs", "theirs");
  std::filesystem::create_symlink("../secret", shared / "link");
  std::filesystem::create_symlink("../none", shared / "dangling");
  std::filesystem::create_symlink("../own", shared / "own");
  ASSERT_EQ(mkfifo((shared / "pipe").c_str(), 0666), 0);
  for (const char* name : {"theirs", "link", "dangling", "own", "pipe"}) give_away(shared / name);
  const auto is_refused = ThrowsMessage<Error>(HasSubstr("of another user, in a folder to which everybody can write"));
  for (const char* name : {"theirs", "link", "dangling", "own/new", "pipe"}) {
    EXPECT_THAT([&] { write_file(shared / name, "new"); }, is_refused) << name;
  }
  for (const char* name : {"link", "own/../secret"}) {
    EXPECT_THAT([&] { read_file(shared / name); }, is_refused) << name;
  }
  std::filesystem::create_directory(shared / "folder");
  write_file(shared / "folder/file", "theirs");
  give_away(shared / "folder");
  for (const char* name : {"theirs", "folder/file"}) {  // a person names them; a file that includes them may not
    EXPECT_EQ(read_file(shared / name).text, "theirs");
    EXPECT_THAT([&] { read_included(shared / name); }, is_refused) << name;
  }
  EXPECT_EQ(text("secret"), "private");
  EXPECT_EQ(text("shared/theirs"), "theirs");
  EXPECT_FALSE(std::filesystem::exists(folder / "none"));
  EXPECT_TRUE(std::filesystem::is_empty(folder / "own"));
  std::filesystem::create_symlink("../secret", shared / "mine");
  write_file(shared / "mine", "changed");
  EXPECT_EQ(text("secret"), "changed");
  ASSERT_EQ(chmod(shared.c_str(), 0755), 0);  // then the owner of the folder has let them in
  write_file(shared / "link", "again");
  EXPECT_EQ(text("secret"), "again");
}

TEST_F(Stores, APathEndsAtItsEnd) {
  const auto is_refused = ThrowsMessage<InvalidArgument>(HasSubstr("expected a path without a zero character"));
  const std::filesystem::path path = folder / std::string("file\0x", 6);
  EXPECT_THAT([&] { write_file(path, "text"); }, is_refused);
  EXPECT_THAT([&] { read_file(path); }, is_refused);
  EXPECT_THAT([&] { read_stored(path); }, is_refused);
  EXPECT_EQ(entries(), 0);
}

}  // namespace
}  // namespace paracal::io::store_test
