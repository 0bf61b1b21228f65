#!/usr/bin/python3
"""A camera on the network, as the robot's video server is one: rtsp_server.py PORT

Ten images a second that tell when they were taken: eight vertical bars, white for the bits that are set of the time in
tenths of a second modulo 256, the most significant one left.
"""
import sys
import time

import gi

gi.require_version("Gst", "1.0")
gi.require_version("GstRtspServer", "1.0")
from gi.repository import GLib, Gst, GstRtspServer  # noqa: E402

WIDTH, HEIGHT, RATE = 352, 288, 10


def bars():
    tenths = int(10.0 * time.time()) % 256
    bar = WIDTH // 8
    row = b"".join((b"\xff" if tenths >> (7 - bit) & 1 else b"\x00") * bar for bit in range(8))
    return row * HEIGHT


def serve(port, picture, width, height, rate):
    """Shows what picture() returns, the bytes of a grey image, so many times a second. Does not return."""

    def push(source):
        buffer = Gst.Buffer.new_wrapped(picture())
        return source.emit("push-buffer", buffer) == Gst.FlowReturn.OK  # False ends the timer, when nobody looks any more

    def start(_, media):
        source = media.get_element().get_by_name_recurse_up("source")
        GLib.timeout_add(1000 // rate, push, source)

    Gst.init(None)
    server = GstRtspServer.RTSPServer()
    server.set_service(port)
    factory = GstRtspServer.RTSPMediaFactory()
    factory.set_launch("( appsrc name=source is-live=true do-timestamp=true format=time"
                       " caps=video/x-raw,format=GRAY8,width=%d,height=%d,framerate=%d/1 ! videoconvert"
                       " ! video/x-raw,format=I420 ! jpegenc ! rtpjpegpay name=pay0 pt=26 )" % (width, height, rate))
    factory.set_shared(True)
    factory.connect("media-configure", start)
    server.get_mount_points().add_factory("/axis-media/media.amp", factory)
    server.attach(None)
    GLib.MainLoop().run()


if __name__ == "__main__":
    serve(sys.argv[1], bars, WIDTH, HEIGHT, RATE)
