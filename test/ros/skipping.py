"""Results of tests that cannot run here: what rostest writes itself knows no skipped tests, and would count them as passed."""
import sys
import xml.etree.ElementTree as ElementTree

XML_OUTPUT = "--gtest_output=xml:"


def skip(name, reason):
    """To be called instead of rostest.rosrun: writes a result with one skipped test, and says why."""
    print("%s skipped: %s" % (name, reason))
    suite = ElementTree.Element("testsuite", name=name, tests="1", failures="0", errors="0")
    case = ElementTree.SubElement(suite, "testcase", classname=name, name=name, time="0")
    ElementTree.SubElement(case, "skipped", message=reason)
    for argument in sys.argv:
        if argument.startswith(XML_OUTPUT):
            path = argument[len(XML_OUTPUT) :]
            ElementTree.ElementTree(suite).write(path, encoding="utf-8", xml_declaration=True)
