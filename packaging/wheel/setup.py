# The module and the program are compiled before (tools/wheel.sh): the wheel is for one kind of machine, although setuptools compiles nothing.
import os

from setuptools import Distribution, setup


class Compiled(Distribution):
    def has_ext_modules(self):
        return True


setup(version=os.environ["PARACAL_VERSION"], distclass=Compiled)
