"""The Debian package: what is in it, what it asks for, and that what was unpacked runs. Installing it into a fresh
system is daemon/package/try_in_fresh_root.sh: minutes, and root."""

import gzip
import os
import subprocess
import unittest

from harness import BIN, Case, HANG_S, environment


class Package(Case):
    def setUp(self):
        super().setUp()
        done = subprocess.run(["cpack", "-G", "DEB", "-B", self.dir / "deb", "--config", BIN.parent / "CPackConfig.cmake"], capture_output=True, text=True,
                              cwd=BIN.parent, timeout=HANG_S, check=False)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.deb, = (self.dir / "deb").glob("*.deb")
        self.root = self.dir / "root"
        subprocess.run(["dpkg-deb", "-x", self.deb, self.root], check=True)

    def field(self, name):
        return subprocess.run(["dpkg-deb", "--field", self.deb, name], capture_output=True, text=True, check=True).stdout.strip()

    def test_it_holds_what_it_should_and_runs(self):
        for path in ["bin/regrasp", "bin/regraspd", "share/regrasp/models/hands/shadow.urdf", "share/man/man1/regrasp.1.gz", "share/man/man8/regraspd.8.gz",
                     "share/man/man7/regrasp-protocol.7.gz", "share/bash-completion/completions/regrasp", "share/zsh/vendor-completions/_regrasp",
                     "share/fish/vendor_completions.d/regrasp.fish", "lib/systemd/system/regraspd.service", "lib/systemd/system/regraspd.socket",
                     "share/doc/regrasp/copyright", "share/doc/regrasp/changelog.gz", "share/doc/regrasp/examples/explore.py"]:
            self.assertTrue((self.root / "usr" / path).is_file(), path)
        self.assertEqual({path.name for path in (self.root / "usr/libexec/regrasp").iterdir()},
                         {"regrasp-film", "regrasp-hand", "regrasp-object", "regrasp-plot-experiment", "regrasp-run"})
        self.assertIn("ExecStart=/usr/bin/regraspd ", (self.root / "usr/lib/systemd/system/regraspd.service").read_text())
        self.assertIn(b'regrasp \\- hold', gzip.decompress((self.root / "usr/share/man/man1/regrasp.1.gz").read_bytes()).replace(b" - ", b" \\- "))
        self.assertFalse((self.root / "etc").exists())  # it needs no file
        # Every file belongs to root and is readable by all.
        listing = subprocess.run(["dpkg-deb", "-c", self.deb], capture_output=True, text=True, check=True).stdout
        for line in listing.splitlines():
            self.assertRegex(line, r"^[-d]rw[-x]r-[-x]r-[-x] root/root ")
        depends = self.field("Depends")
        for package in ("libode8", "libopencv-imgproc", "libc6", "fonts-dejavu-core"):
            self.assertRegex(depends, rf"\b{package}")
        self.assertRegex(self.field("Version"), r"^\d+\.\d+\.\d+$")
        for words in (["usr/bin/regrasp", "version"], ["usr/bin/regraspd", "--check-config"]):
            subprocess.run([self.root / words[0], *words[1:]], env=environment(), check=True, capture_output=True, timeout=HANG_S)
        # The models are those beside the programs, also for those in libexec.
        nowhere = subprocess.run([self.root / "usr/bin/regrasp", "object", "show", "unicorn"], env=environment(), capture_output=True, text=True, timeout=HANG_S, check=False)
        self.assertIn(f'no model "unicorn" in {self.root / "usr/share/regrasp/models/objects"}', nowhere.stderr)
        module = subprocess.run(["python3", "-c", "import regrasp; print(regrasp.__file__)"], env=environment(PYTHONPATH=str(self.root / "usr/lib/python3/dist-packages")),
                                check=True, capture_output=True, text=True, timeout=HANG_S).stdout
        self.assertTrue(module.startswith(str(self.root)), module)

    def test_its_scripts_do_nothing_without_systemd(self):
        control = self.dir / "control"
        subprocess.run(["dpkg-deb", "-e", self.deb, control], check=True)
        for script in ("postinst", "prerm", "postrm"):
            self.assertTrue(os.access(control / script, os.X_OK), script)
            subprocess.run(["sh", "-n", control / script], check=True)
            self.assertIn("/run/systemd/system", (control / script).read_text())


if __name__ == "__main__":
    unittest.main()
