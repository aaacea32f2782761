"""The package is that of the program."""

import unittest

import headpin
import support


class Package(unittest.TestCase):
    def test_has_the_programs_version(self):
        self.assertEqual(support.json_of("replay", support.DEMO)["version"], headpin.__version__)


if __name__ == "__main__":
    unittest.main()
